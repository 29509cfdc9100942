// SPDX-License-Identifier: MIT OR Apache-2.0
//! What each binding of a pass is given, decided before any GPU is asked.

use super::fields::{self, Type};
use super::plan::{Plan, Work};
use super::spelling::{Input, Output, Scalar, Setting};
use super::{Options, texels};
use crate::command::CommandError;
use crate::command::error::{named, one_line};
use crate::formats::{Array, ArrayData, read_npy};
use crate::layout::{kind_text, texture_format};
use airlight_validate::{Binding, BindingKind, Sample, TextureDimension};
use std::path::PathBuf;

/// The name of the target that a full-screen pass draws to.
pub const TARGET: &str = "color";

/// How a resource is made.
pub enum Recipe {
    /// A uniform buffer.
    Uniform(Vec<u8>),
    /// A storage buffer.
    Storage(Vec<u8>),
    /// A texture.
    Texture(TextureRecipe),
    /// A sampler.
    Sampler { comparison: bool },
}

/// How a texture is made.
pub struct TextureRecipe {
    /// Width, height, layers or depth.
    pub size: [u32; 3],
    pub dimension: wgpu::TextureViewDimension,
    pub format: wgpu::TextureFormat,
    pub usage: wgpu::TextureUsages,
    /// Its texels; zeros where there are none.
    pub bytes: Option<Vec<u8>>,
}

/// Where the contents of a resource go.
pub struct Written {
    /// The text of the flag up to the file.
    pub flag: String,
    pub file: PathBuf,
    /// Without the channels of texels.
    pub shape: Vec<usize>,
    /// What a word of a buffer means.
    pub scalar: Scalar,
}

/// A resource and what becomes of it.
pub struct Planned {
    pub name: String,
    pub recipe: Recipe,
    pub written: Option<Written>,
}

/// The resources of a plan, the target of a full-screen pass last.
pub fn resources(
    options: &Options,
    plan: &Plan,
    limits: &wgpu::Limits,
) -> Result<Vec<Planned>, CommandError> {
    check_names(options, plan)?;
    let uniforms = settings(options, plan)?;
    missing(options, plan)?;
    check_size(options, plan)?;
    let mut all = Vec::new();
    for binding in &plan.bindings {
        let place = Place {
            name: &binding.name,
            input: options.input.iter().find(|input| input.name == binding.name),
            output: options.output.iter().find(|output| output.name == binding.name),
            pass: plan.name(),
            size: options.size,
            limits,
        };
        let (recipe, written) = match &binding.kind {
            BindingKind::Uniform { ty, size } => {
                let mut bytes = place.uniform(ty, *size, plan)?;
                for (setting, field, _) in uniforms.iter().filter(|(_, _, name)| *name == binding.name) {
                    fields::set(&mut bytes, ty, field, &setting.value, &plan.structs)
                        .map_err(|problem| set_error(setting, problem))?;
                }
                (Recipe::Uniform(bytes), None)
            }
            BindingKind::Storage { ty, min_size, .. } => place.storage(ty, *min_size, plan)?,
            BindingKind::Texture { dimension, sample, filtered, multisampled } => {
                if *multisampled {
                    return Err(place.impossible("a multisampled texture cannot be filled from an array"));
                }
                (Recipe::Texture(place.sampled(*dimension, *sample, *filtered)?), None)
            }
            BindingKind::StorageTexture { dimension, format, .. } => {
                let format = texture_format(*format)
                    .ok_or_else(|| place.impossible("its format is not one of core WebGPU"))?;
                place.storage_texture(*dimension, format)?
            }
            BindingKind::Sampler { comparison } => (Recipe::Sampler { comparison: *comparison }, None),
            BindingKind::Other { ty } => return Err(place.impossible(&format!("{ty} cannot be bound"))),
        };
        all.push(Planned { name: binding.name.clone(), recipe, written });
    }
    if let Work::Screen { target, size, .. } = plan.work {
        all.push(self::target(options, target, size, limits)?);
    }
    Ok(all)
}

fn described(binding: &Binding) -> String {
    format!("`{}` ({})", binding.name, kind_text(&binding.kind))
}

fn list<'a>(bindings: impl Iterator<Item = &'a Binding>) -> String {
    let list: Vec<_> = bindings.map(described).collect();
    if list.is_empty() { "none".to_owned() } else { list.join(", ") }
}

fn writable(binding: &Binding) -> bool {
    use airlight_validate::Access;
    match &binding.kind {
        BindingKind::Storage { writable, .. } => *writable,
        BindingKind::StorageTexture { access, .. } => *access != Access::Read,
        _ => false,
    }
}

fn input_flag(input: &Input) -> String {
    format!("--in {}={}", input.name, input.file.display())
}

fn output_flag(output: &Output) -> String {
    format!("--out {}={}", output.name, output.file.display())
}

/// Every `--in` and `--out` names a binding once, of a kind that it can be for.
fn check_names(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let find = |name: &str| plan.bindings.iter().find(|binding| binding.name == name);
    let unknown = |flag: String, name: &str| {
        let known = list(plan.bindings.iter());
        CommandError::misuse(&flag, format!("{} has no binding `{name}`; it has {known}", plan.name()))
    };
    for (index, input) in options.input.iter().enumerate() {
        let flag = input_flag(input);
        let binding = find(&input.name).ok_or_else(|| unknown(flag.clone(), &input.name))?;
        if options.input[..index].iter().any(|earlier| earlier.name == input.name) {
            return Err(CommandError::misuse(&flag, format!("`{}` is given twice", input.name)));
        }
        let problem = match &binding.kind {
            BindingKind::Sampler { .. } => "a sampler is made by itself and takes no array",
            BindingKind::Texture { sample: Sample::Depth, .. } => {
                "a depth texture cannot be filled from an array"
            }
            _ => continue,
        };
        return Err(CommandError::misuse(&flag, problem));
    }
    let screen = matches!(plan.work, Work::Screen { .. });
    for (index, output) in options.output.iter().enumerate() {
        let flag = output_flag(output);
        let earlier = &options.output[..index];
        if earlier.iter().any(|earlier| earlier.name == output.name) {
            return Err(CommandError::misuse(&flag, format!("`{}` is given twice", output.name)));
        }
        if earlier.iter().any(|earlier| earlier.file == output.file) {
            return Err(CommandError::misuse(&flag, "another --out has the same file"));
        }
        let outputs = || {
            let mut known = list(plan.bindings.iter().filter(|binding| writable(binding)));
            if screen {
                known = format!("`{TARGET}` (the render target)");
            }
            known
        };
        match find(&output.name) {
            _ if screen && output.name == TARGET => {}
            Some(binding) if writable(binding) => {}
            Some(binding) => {
                let problem = format!(
                    "{} is not written by {}; written are {}",
                    described(binding),
                    plan.name(),
                    outputs()
                );
                return Err(CommandError::misuse(&flag, problem));
            }
            None if screen => {
                let problem =
                    format!("{} writes no `{}`; written are {}", plan.name(), output.name, outputs());
                return Err(CommandError::misuse(&flag, problem));
            }
            None => return Err(unknown(flag, &output.name)),
        }
    }
    Ok(())
}

/// Every resource that must be given is; samplers and uniforms need not be.
fn missing(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let mut wanted = Vec::new();
    for binding in &plan.bindings {
        let name = &binding.name;
        let given = options.input.iter().any(|input| input.name == *name)
            || options.output.iter().any(|output| output.name == *name);
        let shape = match &binding.kind {
            BindingKind::Uniform { .. } | BindingKind::Sampler { .. } => continue,
            _ if given => continue,
            BindingKind::Texture { sample: Sample::Depth, .. } => {
                let problem =
                    format!("{} needs {}, which no array can fill", plan.name(), described(binding));
                return Err(CommandError::Misuse(problem));
            }
            BindingKind::StorageTexture { dimension: TextureDimension::D2, .. } => "HEIGHT,WIDTH",
            BindingKind::StorageTexture { .. } => "LAYERS,HEIGHT,WIDTH",
            _ => "COUNT",
        };
        let kind = kind_text(&binding.kind);
        wanted.push(if writable(binding) {
            format!("`--out {name}=FILE.npy:{shape}` ({kind})")
        } else {
            format!("`--in {name}=FILE.npy` ({kind})")
        });
    }
    if matches!(plan.work, Work::Screen { .. }) && !options.output.iter().any(|output| output.name == TARGET)
    {
        wanted.push(format!("`--out {TARGET}=FILE.npy` (the render target)"));
    }
    if !wanted.is_empty() {
        return Err(CommandError::Misuse(format!("{} needs {}", plan.name(), wanted.join(" and "))));
    }
    if options.output.is_empty() {
        let known = list(plan.bindings.iter().filter(|binding| writable(binding)));
        return Err(CommandError::misuse(
            "--out",
            format!("nothing would be kept; {} writes {known}", plan.name()),
        ));
    }
    Ok(())
}

/// `--size` is for targets, and for flat storage textures that are neither given nor sized otherwise.
fn check_size(options: &Options, plan: &Plan) -> Result<(), CommandError> {
    let (Some([width, height]), Work::Compute { .. }) = (options.size, &plan.work) else { return Ok(()) };
    let takes = |binding: &Binding| {
        let flat =
            matches!(binding.kind, BindingKind::StorageTexture { dimension: TextureDimension::D2, .. });
        let given = options.input.iter().any(|input| input.name == binding.name);
        let open = |output: &Output| output.name == binding.name && output.shape.is_none();
        flat && !given && options.output.iter().any(open)
    };
    if plan.bindings.iter().any(takes) {
        return Ok(());
    }
    let problem = format!("{} has no 2d storage texture among --out that lacks a SHAPE", plan.name());
    Err(CommandError::misuse(&format!("--size {width}x{height}"), problem))
}

fn set_error(setting: &Setting, problem: String) -> CommandError {
    CommandError::misuse(&format!("--set {}={}", setting.path, setting.value), problem)
}

/// Each `--set` with the path inside its uniform and the name of that uniform, found by name or by struct.
fn settings<'a>(
    options: &'a Options,
    plan: &'a Plan,
) -> Result<Vec<(&'a Setting, &'a str, &'a str)>, CommandError> {
    let mut found = Vec::new();
    for setting in &options.set {
        let end = setting.path.find(['.', '[']).unwrap_or(setting.path.len());
        let (name, field) = setting.path.split_at(end);
        let field = field.strip_prefix('.').unwrap_or(field);
        let uniforms = || {
            plan.bindings.iter().filter_map(|binding| match &binding.kind {
                BindingKind::Uniform { ty, .. } => Some((binding, ty)),
                _ => None,
            })
        };
        let known = || {
            let list: Vec<_> = uniforms().map(|(binding, ty)| format!("{} ({ty})", binding.name)).collect();
            if list.is_empty() { "none".to_owned() } else { list.join(", ") }
        };
        if let Some((binding, ty)) = uniforms().find(|(binding, _)| binding.name == name) {
            check_field(setting, ty, field, plan)?;
            found.push((setting, field, binding.name.as_str()));
            continue;
        }
        if let Some(binding) = plan.bindings.iter().find(|binding| binding.name == name) {
            let problem =
                format!("{} is no uniform; uniforms of {} are {}", described(binding), plan.name(), known());
            return Err(set_error(setting, problem));
        }
        let typed: Vec<_> = uniforms().filter(|(_, ty)| *ty == name).collect();
        match typed[..] {
            [(binding, ty)] => {
                check_field(setting, ty, field, plan)?;
                found.push((setting, field, binding.name.as_str()));
            }
            [] => {
                let problem = format!("{} has no uniform `{name}`; it has {}", plan.name(), known());
                return Err(set_error(setting, problem));
            }
            _ => {
                let problem = format!("several uniforms are a {name}; name one of {}", known());
                return Err(set_error(setting, problem));
            }
        }
    }
    Ok(found)
}

/// Writes into a copy, so that a wrong field is found before files are read.
fn check_field(setting: &Setting, ty: &str, field: &str, plan: &Plan) -> Result<(), CommandError> {
    let size = plan.bindings.iter().find_map(|binding| match &binding.kind {
        BindingKind::Uniform { ty: of, size } if of == ty => Some(*size as usize),
        _ => None,
    });
    let mut bytes = vec![0; size.unwrap_or(0)];
    fields::set(&mut bytes, ty, field, &setting.value, &plan.structs)
        .map_err(|problem| set_error(setting, problem))
}

/// A binding with what was said about it.
struct Place<'a> {
    name: &'a str,
    input: Option<&'a Input>,
    output: Option<&'a Output>,
    pass: String,
    size: Option<[u32; 2]>,
    limits: &'a wgpu::Limits,
}

/// An array with the flag that named it.
struct Given {
    flag: String,
    shape: Vec<usize>,
    /// As a shader takes it.
    data: ArrayData,
    /// As it is in the file.
    type_name: &'static str,
}

impl Given {
    fn wrong(&self, problem: impl std::fmt::Display) -> CommandError {
        CommandError::failure(format!("{}: {problem}", self.flag))
    }

    fn bytes(&self) -> Option<(Scalar, Vec<u8>)> {
        match &self.data {
            ArrayData::F32(values) => {
                Some((Scalar::F32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            ArrayData::U32(values) => {
                Some((Scalar::U32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            ArrayData::I32(values) => {
                Some((Scalar::I32, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
            }
            _ => None,
        }
    }
}

fn shape_text(shape: &[usize]) -> String {
    let sides: Vec<_> = shape.iter().map(usize::to_string).collect();
    format!("({})", sides.join(", "))
}

impl Place<'_> {
    fn impossible(&self, problem: &str) -> CommandError {
        CommandError::Misuse(format!("{}: `{}`: {problem}", self.pass, self.name))
    }

    fn given(&self) -> Result<Option<Given>, CommandError> {
        let Some(input) = self.input else { return Ok(None) };
        let flag = input_flag(input);
        let array = read_npy(&input.file).map_err(|error| {
            CommandError::failure(format!("--in {}: {}", input.name, named(&input.file, one_line(error))))
        })?;
        let Array { shape, data } = array;
        let type_name = data.type_name();
        Ok(Some(Given { flag, shape, data: data.to_shader_types(), type_name }))
    }

    /// The bytes of an array of words whose type must be `scalar`, where that is known.
    fn words(
        &self,
        given: &Given,
        ty: &str,
        scalar: Option<Scalar>,
    ) -> Result<(Scalar, Vec<u8>), CommandError> {
        let (found, bytes) = given.bytes().ok_or_else(|| {
            given.wrong(format!("`{}` is {ty} and takes f32, u32 or i32, not {}", self.name, given.type_name))
        })?;
        match scalar {
            Some(wanted) if wanted != found => Err(given.wrong(format!(
                "`{}` is {ty} and takes {}, not {}",
                self.name,
                wanted.name(),
                found.name()
            ))),
            _ => Ok((found, bytes)),
        }
    }

    fn uniform(&self, ty: &str, size: u64, plan: &Plan) -> Result<Vec<u8>, CommandError> {
        let limit = self.limits.max_uniform_buffer_binding_size;
        if size > limit {
            return Err(self.impossible(&format!("{ty} is {size} bytes; a device takes at most {limit}")));
        }
        let Some(given) = self.given()? else { return Ok(vec![0; size as usize]) };
        let (_, bytes) = self.words(&given, ty, uniform_scalar(ty, plan))?;
        if bytes.len() as u64 != size {
            let (given_words, words) = (bytes.len() / 4, size / 4);
            return Err(given.wrong(format!(
                "{given_words} numbers in {}; {ty} takes {words}",
                shape_text(&given.shape)
            )));
        }
        Ok(bytes)
    }

    fn storage(
        &self,
        ty: &str,
        min_size: u64,
        plan: &Plan,
    ) -> Result<(Recipe, Option<Written>), CommandError> {
        let spelled = Type::new(ty, &plan.structs);
        let scalar = spelled.scalar(&plan.structs);
        let open_end = spelled.open_end(&plan.structs);
        let fits = |bytes: u64| match open_end {
            Some((before, stride)) => bytes >= min_size && (bytes - before).is_multiple_of(stride.max(1)),
            None => bytes == min_size,
        };
        let wanted = || match open_end {
            Some((0, stride)) => format!("{ty} takes a multiple of {}", stride / 4),
            Some((before, stride)) => format!("{ty} takes {} and a multiple of {}", before / 4, stride / 4),
            None => format!("{ty} takes {}", min_size / 4),
        };
        let limit = self.limits.max_storage_buffer_binding_size;
        let too_large = |bytes: u128| {
            (bytes > u128::from(limit))
                .then(|| format!("{bytes} bytes; a device binds at most {limit} bytes as a storage buffer"))
        };

        let given = self.given()?;
        let mut contents = None;
        if let Some(given) = &given {
            let (found, bytes) = self.words(given, ty, scalar)?;
            if !fits(bytes.len() as u64) {
                return Err(given.wrong(format!(
                    "{} numbers in {}; {}",
                    bytes.len() / 4,
                    shape_text(&given.shape),
                    wanted()
                )));
            }
            if let Some(problem) = too_large(bytes.len() as u128) {
                return Err(given.wrong(problem));
            }
            contents = Some((found, bytes));
        }
        let Some(output) = self.output else {
            let bytes = contents.map(|(_, bytes)| bytes).unwrap_or_default();
            return Ok((Recipe::Storage(bytes), None));
        };
        let flag = output_flag(output);
        let count = output
            .shape
            .as_ref()
            .map(|shape| shape.iter().map(|side| u128::from(*side)).fold(1, u128::saturating_mul));
        let shape_given =
            || output.shape.as_deref().unwrap_or_default().iter().map(|side| *side as usize).collect();
        let (shape, default_scalar, bytes): (Vec<usize>, _, _) = match (contents, count) {
            (Some((found, bytes)), None) => {
                (given.map(|given| given.shape).unwrap_or_default(), found, bytes)
            }
            (Some((found, bytes)), Some(count)) if count == bytes.len() as u128 / 4 => {
                (shape_given(), found, bytes)
            }
            (Some((_, bytes)), Some(count)) => {
                let problem =
                    format!("the shape holds {count} numbers; the array of --in has {}", bytes.len() / 4);
                return Err(CommandError::misuse(&flag, problem));
            }
            (None, None) if open_end.is_none() => {
                (vec![min_size as usize / 4], Scalar::F32, vec![0; min_size as usize])
            }
            (None, None) => {
                let problem = format!("say how many numbers, {}=FILE.npy:COUNT; {}", self.name, wanted());
                return Err(CommandError::misuse(&flag, problem));
            }
            (None, Some(count)) => {
                let size = count.saturating_mul(4);
                if let Some(problem) = too_large(size) {
                    return Err(CommandError::misuse(&flag, problem));
                }
                if !fits(size as u64) {
                    return Err(CommandError::misuse(
                        &flag,
                        format!("the shape holds {count} numbers; {}", wanted()),
                    ));
                }
                (shape_given(), Scalar::F32, vec![0; size as usize])
            }
        };
        let scalar = output.scalar.or(scalar).unwrap_or(default_scalar);
        let written = Written { flag, file: output.file.clone(), shape, scalar };
        Ok((Recipe::Storage(bytes), Some(written)))
    }

    /// Width, height and layers, and channels, of an array.
    fn extent(&self, given: &Given, dimension: TextureDimension) -> Result<([u32; 3], u32), CommandError> {
        let (flat, names) = match dimension {
            TextureDimension::D2 => (true, "(height, width) or (height, width, channels)"),
            TextureDimension::D2Array => {
                (false, "(layers, height, width) or (layers, height, width, channels)")
            }
            TextureDimension::D3 => (false, "(depth, height, width) or (depth, height, width, channels)"),
            _ => {
                return Err(self.impossible(&format!("a {dimension} texture cannot be filled from an array")));
            }
        };
        let small: Option<Vec<u32>> = given.shape.iter().map(|side| u32::try_from(*side).ok()).collect();
        let found = match (flat, small.as_deref()) {
            (true, Some(&[height, width])) => Some(([width, height, 1], 1)),
            (true, Some(&[height, width, channels])) => Some(([width, height, 1], channels)),
            (false, Some(&[layers, height, width])) => Some(([width, height, layers], 1)),
            (false, Some(&[layers, height, width, channels])) => Some(([width, height, layers], channels)),
            _ => None,
        };
        let (size, channels) = found
            .filter(|(size, channels)| (1..=4).contains(channels) && size.iter().all(|side| *side > 0))
            .ok_or_else(|| {
                let shape = shape_text(&given.shape);
                given.wrong(format!("shape {shape}; `{}` takes {names}, with 1 to 4 channels", self.name))
            })?;
        if let Some(problem) = self.too_large(size, dimension) {
            return Err(given.wrong(problem));
        }
        Ok((size, channels))
    }

    fn too_large(&self, size: [u32; 3], dimension: TextureDimension) -> Option<String> {
        let limits = self.limits;
        let (side, depth) = match dimension {
            TextureDimension::D3 => (limits.max_texture_dimension_3d, limits.max_texture_dimension_3d),
            _ => (limits.max_texture_dimension_2d, limits.max_texture_array_layers),
        };
        let [width, height, layers] = size;
        (width > side || height > side || layers > depth).then(|| match dimension {
            TextureDimension::D2 => {
                format!("height {height} and width {width}; a device takes at most {side} each")
            }
            _ => format!(
                "{layers} layers of height {height} and width {width}; a device takes at most {depth} layers of {side} each"
            ),
        })
    }

    fn sampled(
        &self,
        dimension: TextureDimension,
        sample: Sample,
        filtered: bool,
    ) -> Result<TextureRecipe, CommandError> {
        let Some(given) = self.given()? else {
            return Err(self.impossible("nothing was given"));
        };
        let (size, channels) = self.extent(&given, dimension)?;
        let format = texels::format_for(sample, filtered, channels, &given.data).map_err(|wanted| {
            given.wrong(format!("`{}` takes {wanted}, not {}", self.name, given.type_name))
        })?;
        let bytes = texels::encode(format, channels, &given.data).map_err(|problem| given.wrong(problem))?;
        Ok(TextureRecipe {
            size,
            dimension: view(dimension),
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            bytes: Some(bytes),
        })
    }

    fn storage_texture(
        &self,
        dimension: TextureDimension,
        format: wgpu::TextureFormat,
    ) -> Result<(Recipe, Option<Written>), CommandError> {
        let mut bytes = None;
        let mut size = None;
        if let Some(given) = self.given()? {
            let (extent, channels) = self.extent(&given, dimension)?;
            let components = u32::from(format.components());
            if channels != components && (channels, components) != (3, 4) {
                return Err(given.wrong(format!(
                    "{channels} channels; `{}` is {format:?} and takes {components}",
                    self.name
                )));
            }
            bytes =
                Some(texels::encode(format, channels, &given.data).map_err(|problem| given.wrong(problem))?);
            size = Some(extent);
        }
        let mut written = None;
        if let Some(output) = self.output {
            let flag = output_flag(output);
            let named = self.output_extent(output, &flag, dimension)?;
            let extent = match (size, named) {
                (Some(size), Some(named)) if size != named => {
                    return Err(CommandError::misuse(&flag, "the shape is not that of the array of --in"));
                }
                (Some(size), _) | (None, Some(size)) => size,
                (None, None) => {
                    let names = if dimension == TextureDimension::D2 {
                        "HEIGHT,WIDTH"
                    } else {
                        "LAYERS,HEIGHT,WIDTH"
                    };
                    let problem = format!("say how large it is, {}=FILE.npy:{names}", self.name);
                    return Err(CommandError::misuse(&flag, problem));
                }
            };
            check_copy(&flag, extent, format, self.limits)?;
            let [width, height, layers] = extent.map(|side| side as usize);
            let shape = if dimension == TextureDimension::D2 {
                vec![height, width]
            } else {
                vec![layers, height, width]
            };
            written = Some(Written { flag, file: output.file.clone(), shape, scalar: Scalar::F32 });
            size = Some(extent);
        }
        let Some(size) = size else { return Err(self.impossible("nothing was given")) };
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC;
        let recipe = TextureRecipe { size, dimension: view(dimension), format, usage, bytes };
        Ok((Recipe::Texture(recipe), written))
    }

    fn output_extent(
        &self,
        output: &Output,
        flag: &str,
        dimension: TextureDimension,
    ) -> Result<Option<[u32; 3]>, CommandError> {
        no_type(output, flag)?;
        let extent = match (dimension, output.shape.as_deref()) {
            (TextureDimension::D2, None) => match self.size {
                Some([width, height]) => [width, height, 1],
                None => return Ok(None),
            },
            (_, None) => return Ok(None),
            (TextureDimension::D2, Some(&[height, width])) => [width, height, 1],
            (TextureDimension::D2Array | TextureDimension::D3, Some(&[layers, height, width])) => {
                [width, height, layers]
            }
            (TextureDimension::D2, Some(_)) => {
                return Err(CommandError::misuse(flag, "the shape of this texture is HEIGHT,WIDTH"));
            }
            (TextureDimension::D2Array | TextureDimension::D3, Some(_)) => {
                return Err(CommandError::misuse(flag, "the shape of this texture is LAYERS,HEIGHT,WIDTH"));
            }
            (_, Some(_)) => {
                return Err(self.impossible(&format!("a {dimension} storage texture cannot be made")));
            }
        };
        match self.too_large(extent, dimension) {
            Some(problem) => Err(CommandError::misuse(flag, problem)),
            None => Ok(Some(extent)),
        }
    }
}

fn uniform_scalar(ty: &str, plan: &Plan) -> Option<Scalar> {
    // Structs travel as raw words: what `--out` of a struct writes, `--in` takes back.
    match Type::new(ty, &plan.structs) {
        Type::Struct(_) => None,
        other => other.scalar(&plan.structs),
    }
}

fn no_type(output: &Output, flag: &str) -> Result<(), CommandError> {
    match output.scalar {
        Some(scalar) => Err(CommandError::misuse(
            flag,
            format!("type {} is for buffers; that of a texture is its format's", scalar.name()),
        )),
        None => Ok(()),
    }
}

/// Texels are read back through one buffer.
fn check_copy(
    flag: &str,
    size: [u32; 3],
    format: wgpu::TextureFormat,
    limits: &wgpu::Limits,
) -> Result<(), CommandError> {
    let bytes = copy_size(size, format);
    if bytes > limits.max_buffer_size {
        let limit = limits.max_buffer_size;
        return Err(CommandError::misuse(
            flag,
            format!("{bytes} bytes; a device reads back at most {limit} at once"),
        ));
    }
    Ok(())
}

/// Bytes of a row of texels in a buffer.
pub fn copy_row(width: u32, format: wgpu::TextureFormat) -> u32 {
    (width * format.block_copy_size(None).unwrap_or(16)).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// Bytes of a texture in a buffer.
pub fn copy_size(size: [u32; 3], format: wgpu::TextureFormat) -> u64 {
    u64::from(copy_row(size[0], format)) * u64::from(size[1]) * u64::from(size[2])
}

fn view(dimension: TextureDimension) -> wgpu::TextureViewDimension {
    match dimension {
        TextureDimension::D2Array => wgpu::TextureViewDimension::D2Array,
        TextureDimension::D3 => wgpu::TextureViewDimension::D3,
        // The others never come this far.
        _ => wgpu::TextureViewDimension::D2,
    }
}

fn target(
    options: &Options,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    limits: &wgpu::Limits,
) -> Result<Planned, CommandError> {
    let output = options.output.iter().find(|output| output.name == TARGET);
    let output =
        output.ok_or_else(|| CommandError::misuse("--out", format!("{TARGET}=FILE.npy is needed")))?;
    let flag = output_flag(output);
    no_type(output, &flag)?;
    if output.shape.as_ref().is_some_and(|shape| *shape != [height, width]) {
        return Err(CommandError::misuse(
            &flag,
            format!("the target is {height},{width} (height, width) by --size"),
        ));
    }
    let size = [width, height, 1];
    check_copy(&flag, size, format, limits)?;
    let recipe = TextureRecipe {
        size,
        dimension: wgpu::TextureViewDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        bytes: None,
    };
    let shape = vec![height as usize, width as usize];
    let written = Written { flag, file: output.file.clone(), shape, scalar: Scalar::F32 };
    Ok(Planned { name: TARGET.to_owned(), recipe: Recipe::Texture(recipe), written: Some(written) })
}
