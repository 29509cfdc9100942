// SPDX-License-Identifier: MIT OR Apache-2.0
//! Records passes with their inputs and results, so that another implementation can repeat them.
//!
//! A [`Recorder`] watches a device ([`Gpu::watched_by`]) and writes into a folder:
//!
//! - `device.json`: adapter and driver;
//! - `shaders/N.wgsl` and `N.json`: the stand-alone text of a pass, what it was composed of;
//! - `cases/N.json`: one dispatch or render pass in the words of WebGPU's JavaScript interface, with the names of the blobs
//!   that its resources held before and after;
//! - `blobs/HASH`: bytes of a buffer, or of a texture level by level, rows without padding;
//! - `snapshots.jsonl`: which pass wrote what a snapshot holds.
//!
//! Of each pass in one scene (a thread's name, which is that of a test) the first, second, fourth … sixteenth run are kept.

mod describe;
mod staging;
mod store;
mod words;

use crate::gpu::Gpu;
use crate::pass::watch::{Held, Run, Watcher};
use airlight_validate::{Composed, Library};
use describe::{Described, Id};
use serde_json::json;
use staging::Staged;
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use store::Store;

/// Runs of a pass in a scene that are kept.
const KEPT: [usize; 5] = [1, 2, 4, 8, 16];

/// Why passes could not be recorded.
#[derive(Clone, Debug, thiserror::Error)]
pub enum CaptureError {
    /// A file.
    #[error("cannot write {path}: {message}")]
    File {
        /// The file.
        path: String,
        /// What the system said.
        message: String,
    },
    /// A shader has no stand-alone form.
    #[error("{pass} cannot be written as stand-alone WGSL: {message}")]
    Shader {
        /// The pass.
        pass: String,
        /// Why.
        message: String,
    },
    /// Nothing was read before.
    #[error("snapshot {0} was taken of nothing that was read from the device")]
    NothingRead(String),
}

/// Writes what a device runs into a folder.
pub struct Recorder {
    device: wgpu::Device,
    library: Library,
    state: Mutex<State>,
}

struct State {
    store: Store,
    shaders: Vec<Shader>,
    runs: HashMap<(String, String), usize>,
    /// Who wrote a resource last.
    writers: HashMap<Id, Output>,
    /// What was written, by its bytes, in this scene.
    contents: HashMap<(String, String), Output>,
    pending: Vec<Pending>,
    cases: usize,
    last_read: Option<(Id, String)>,
    failure: Option<CaptureError>,
}

/// A shader as cases name it.
struct Shader {
    pass: String,
    definitions: String,
    permutation: Option<String>,
    words: HashMap<String, serde_json::Value>,
}

impl Shader {
    /// `system/pass:permutation`, or with the definitions in brackets where those are not of a shipped permutation.
    fn name(&self) -> String {
        match &self.permutation {
            Some(permutation) => format!("{}:{permutation}", self.pass),
            None => format!("{}[{}]", self.pass, self.definitions),
        }
    }
}

/// Something that a pass writes.
#[derive(Clone)]
struct Output {
    key: String,
    name: String,
}

/// A case whose commands are recorded.
struct Pending {
    scene: String,
    described: Described,
    before: Vec<Staged>,
    /// With the places of the resources in the list of `before`.
    after: Vec<(usize, Staged)>,
}

impl Recorder {
    /// Records what `gpu` will run into `folder`, which is made and should be empty.
    ///
    /// # Errors
    /// [`CaptureError::File`].
    pub fn new(gpu: &Gpu, folder: &Path) -> Result<Self, CaptureError> {
        let store = Store::new(folder)?;
        store.write("device.json", json!({ "adapter": gpu.description() }).to_string().as_bytes())?;
        let state = State {
            store,
            shaders: Vec::new(),
            runs: HashMap::new(),
            writers: HashMap::new(),
            contents: HashMap::new(),
            pending: Vec::new(),
            cases: 0,
            last_read: None,
            failure: None,
        };
        Ok(Self { device: gpu.device.clone(), library: Library::builtin(), state: Mutex::new(state) })
    }

    /// Notes that the snapshot `name` holds what was read last from the device.
    ///
    /// # Errors
    /// [`CaptureError`]; also of what went wrong before this call.
    pub fn snapshot(&self, name: &str) -> Result<(), CaptureError> {
        let mut state = self.state();
        if let Some(failure) = state.failure.clone() {
            return Err(failure);
        }
        let (resource, contents) =
            state.last_read.take().ok_or_else(|| CaptureError::NothingRead(name.to_owned()))?;
        let scene = scene();
        // What was copied from another resource is known by its bytes.
        let writer =
            state.writers.get(&resource).or_else(|| state.contents.get(&(scene.clone(), contents))).cloned();
        let line = json!({
            "snapshot": name,
            "scene": scene,
            "key": writer.as_ref().map(|output| &output.key),
            "output": writer.as_ref().map(|output| &output.name),
        });
        state.store.append("snapshots.jsonl", &line.to_string())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn shader(&self, state: &State, composed: &Composed) -> Result<Shader, CaptureError> {
        let error = |error: airlight_validate::Error| CaptureError::Shader {
            pass: composed.pass.clone(),
            message: error.to_string(),
        };
        let text = airlight_validate::flat::write(composed).map_err(error)?;
        let shipped = self.library.permutations(&composed.pass).unwrap_or_default();
        let shipped = shipped.iter().find(|permutation| permutation.definitions == composed.definitions);
        let shader = Shader {
            pass: composed.pass.clone(),
            definitions: composed.definitions.to_string(),
            permutation: shipped.map(|permutation| permutation.name.clone()),
            words: words::of_buffers(&composed.module),
        };
        let about = json!({
            "pass": shader.pass, "definitions": shader.definitions, "permutation": shader.permutation,
        });
        let number = state.shaders.len();
        state.store.write(&format!("shaders/{number}.wgsl"), text.as_bytes())?;
        state.store.write(&format!("shaders/{number}.json"), about.to_string().as_bytes())?;
        Ok(shader)
    }
}

impl Watcher for Recorder {
    fn built(&self, composed: &Composed) -> usize {
        let mut state = self.state();
        let definitions = composed.definitions.to_string();
        let known = state
            .shaders
            .iter()
            .position(|shader| shader.pass == composed.pass && shader.definitions == definitions);
        known.unwrap_or_else(|| match self.shader(&state, composed) {
            Ok(shader) => {
                state.shaders.push(shader);
                state.shaders.len() - 1
            }
            Err(failure) => {
                state.failure.get_or_insert(failure);
                usize::MAX
            }
        })
    }

    fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        run: &Run<'_>,
        record: &mut dyn FnMut(&mut wgpu::CommandEncoder),
    ) {
        let mut state = self.state();
        let described = describe::describe(run, &state.shaders);
        for (id, name) in &described.outputs {
            let output = Output { key: described.key.clone(), name: name.clone() };
            state.writers.insert(id.clone(), output);
        }
        let scene = scene();
        let count = state.runs.entry((scene.clone(), described.key.clone())).or_insert(0);
        *count += 1;
        if !KEPT.contains(count) {
            drop(state);
            return record(encoder);
        }
        let stage = |encoder: &mut wgpu::CommandEncoder, id: &Id| staging::stage(&self.device, encoder, id);
        let before = described.resources.iter().map(|id| stage(encoder, id)).collect();
        record(encoder);
        let written = described.resources.iter().enumerate();
        let written = written.filter(|(_, id)| described.outputs.iter().any(|(output, _)| output == *id));
        let after = written.map(|(place, id)| (place, stage(encoder, id))).collect();
        state.pending.push(Pending { scene, described, before, after });
    }

    fn submitted(&self, gpu: &Gpu) {
        if self.state().pending.is_empty() {
            return;
        }
        // What fails here is the next call's error.
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        let mut state = self.state();
        let pending = std::mem::take(&mut state.pending);
        for case in pending {
            if !case.before.iter().chain(case.after.iter().map(|(_, staged)| staged)).all(Staged::is_ready) {
                // Of an encoder that is not submitted yet.
                state.pending.push(case);
            } else if let Err(failure) = state.write(case) {
                state.failure.get_or_insert(failure);
            }
        }
    }

    fn read(&self, resource: Held, contents: &[u8]) {
        if let Some(id) = Id::of(&resource) {
            self.state().last_read = Some((id, store::name_of(contents)));
        }
    }
}

impl State {
    fn write(&mut self, case: Pending) -> Result<(), CaptureError> {
        let Pending { scene, mut described, before, after } = case;
        let mut contents: Vec<serde_json::Value> = Vec::new();
        for staged in &before {
            contents.push(json!({ "before": staged.save(&self.store)? }));
        }
        for (place, staged) in &after {
            let blob = staged.save(&self.store)?;
            let id = &described.resources[*place];
            for (_, name) in described.outputs.iter().filter(|(output, _)| output == id) {
                let output = Output { key: described.key.clone(), name: name.clone() };
                if let Some(blob) = &blob {
                    self.contents.insert((scene.clone(), blob.clone()), output);
                }
            }
            contents[*place]["after"] = json!(blob);
        }
        for (resource, contents) in described.list.iter_mut().zip(contents) {
            resource["before"] = contents["before"].clone();
            resource["after"] = contents["after"].clone();
        }
        let number = self.cases;
        self.cases += 1;
        let text = json!({
            "scene": scene,
            "key": described.key,
            "shaders": described.shaders,
            "resources": described.list,
            "samplers": described.samplers,
            "outputs": described.named_outputs(),
            "run": described.run,
        });
        self.store.write(&format!("cases/{number}.json"), text.to_string().as_bytes())
    }
}

/// The name of the test that runs.
fn scene() -> String {
    std::thread::current().name().unwrap_or("main").to_owned()
}
