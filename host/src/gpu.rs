// SPDX-License-Identifier: MIT OR Apache-2.0
//! The adapter, the device, the queue.

use crate::pass::watch::Watcher;
use std::sync::{Arc, Mutex};

/// Why there is no device, or why work on it failed.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no GPU adapter was found: install a Vulkan driver (Debian or Ubuntu: mesa-vulkan-drivers, a software \
         driver that needs no GPU)"
    )]
    NoAdapter,
    /// The adapter cannot give WebGPU's default limits.
    #[error("adapter {adapter} gives no device with WebGPU's default limits: {message}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        message: String,
    },
    /// A call was refused by validation, or memory ran out.
    #[error("the GPU refused the work: {0}")]
    Refused(String),
    /// Work did not finish, or a buffer could not be mapped.
    #[error("the GPU's results could not be read: {0}")]
    Reading(String),
}

/// An adapter with its device and queue, on WebGPU's default limits and no optional feature.
///
/// What runs here therefore runs on every WebGPU implementation, as far as limits go.
pub struct Gpu {
    /// Name, driver and back end.
    pub adapter: wgpu::AdapterInfo,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The limits requested from it.
    pub limits: wgpu::Limits,
    uncaptured: Arc<Mutex<Option<String>>>,
    watcher: Option<Arc<dyn Watcher>>,
}

impl Gpu {
    /// Opens the adapter that the system prefers.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] and [`GpuError::NoDevice`].
    pub async fn new() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                ..Default::default()
            })
            .await
            .map_err(|_| GpuError::NoAdapter)?;
        let info = adapter.get_info();
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("airlight"),
                required_limits: wgpu::Limits::default(),
                ..Default::default()
            })
            .await
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), message: error.to_string() })?;
        Ok(Self::from_device(info, device, queue))
    }

    /// Takes the device of an engine. Its handler of uncaptured errors is replaced.
    pub fn from_device(adapter: wgpu::AdapterInfo, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        // wgpu panics on uncaptured errors by default; they are kept instead, and returned by the next `submit`.
        let uncaptured = Arc::new(Mutex::new(None));
        let kept = Arc::clone(&uncaptured);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut first) = kept.lock() {
                first.get_or_insert(error.to_string());
            }
        }));
        let limits = device.limits();
        Self { adapter, device, queue, limits, uncaptured, watcher: None }
    }

    /// Shows `watcher` all passes that are built and recorded from now on.
    #[must_use]
    pub fn watched_by(mut self, watcher: Arc<dyn Watcher>) -> Self {
        self.watcher = Some(watcher);
        self
    }

    pub(crate) fn watcher(&self) -> Option<&Arc<dyn Watcher>> {
        self.watcher.as_ref()
    }

    /// A new command encoder.
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Submits what was recorded.
    ///
    /// # Errors
    /// [`GpuError::Refused`] with the first error since the last call.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.queue.submit([encoder.finish()]);
        if let Some(watcher) = &self.watcher {
            watcher.submitted(self);
        }
        self.check()
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`GpuError::Refused`], [`GpuError::Reading`].
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| GpuError::Reading(error.to_string()))?;
        self.check()
    }

    /// The first error that no scope caught since the last call, if any.
    ///
    /// # Errors
    /// [`GpuError::Refused`].
    pub fn check(&self) -> Result<(), GpuError> {
        let kept = self.uncaptured.lock().map_or(None, |mut first| first.take());
        kept.map_or(Ok(()), |message| Err(GpuError::Refused(message)))
    }

    /// Name of the adapter and of its driver, as recorded with snapshots and benchmarks.
    pub fn description(&self) -> String {
        format!("{} ({} {})", self.adapter.name, self.adapter.driver, self.adapter.driver_info)
    }
}
