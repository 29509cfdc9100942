// SPDX-License-Identifier: MIT OR Apache-2.0
//! Temporary.
use airlight::core::*;use airlight::scattering::*;use airlight::*;
fn main() {
    let gpu = pollster::block_on(Gpu::new()).unwrap();
    let shaders = Shaders::builtin();
    let size = [1280u32, 720];
    for name in std::env::args().skip(1) {
        let scene = scenes::scene(&name).unwrap().unwrap();
        println!("{name} {} triangles", scene.mesh.triangle_count());
        let camera = Camera::perspective(&scene.view, size).unwrap();
        let b = scene.mesh.bounds().unwrap();
        let light = Light::directional(scene.light, scene.radiance, b.min, b.max).unwrap();
        let raster = Raster::new(&gpu, &shaders).unwrap();
        let meshes = [MeshBuffers::new(&gpu, &scene.mesh)];
        let pics = raster.render(&gpu, &camera, &light, &scene.sky, &meshes, [2048, 2048]).unwrap();
        let (c, l, m) = (Buffer::uniform(&gpu, &camera), Buffer::uniform(&gpu, &light), Buffer::uniform(&gpu, &scene.medium));
        let inputs = Inputs { camera: &c, light: &l, medium: &m, depth: &pics.depth, shadow_map: &pics.shadow_map };
        let pre = Prefiltered::new(&gpu, &shaders, Settings::default(), size).unwrap();
        let bound = pre.bind(&gpu, &inputs).unwrap();
        let march = March::new(&gpu, &shaders, &Along::ShadowMap { steps: 1024 }, Weighting::Transmittance, size).unwrap();
        let mb = march.bind(&gpu, &inputs, &Along::ShadowMap { steps: 1024 }).unwrap();
        let rows = March::new(&gpu, &shaders, &Along::Rows(&pre.rectification), Weighting::Transmittance, size).unwrap();
        let rb = rows.bind(&gpu, &inputs, &Along::Rows(&pre.rectification)).unwrap();
        for _ in 0..3 {
            let time = |f: &mut dyn FnMut(&mut wgpu::CommandEncoder)| { let t = std::time::Instant::now(); let mut e = gpu.encoder(); f(&mut e); gpu.submit(e).unwrap(); gpu.wait().unwrap(); t.elapsed().as_secs_f64() * 1e3 };
            println!("rect {:.1} filter {:.1} eval {:.1} march {:.1} rows {:.1}", time(&mut |e| pre.record_rectification(e, &bound)), time(&mut |e| pre.record_filter(e, &bound)), time(&mut |e| pre.record_evaluation(e, &bound)), time(&mut |e| march.record(e, &mb)), time(&mut |e| rows.record(e, &rb)));
        }
        let comp = Composite::new(&gpu, &shaders).unwrap();
        let tone = Tonemap::new(&gpu, &shaders).unwrap();
        let save = |t: &Texture, n: &str| { let px = tone.run(&gpu, t, scene.exposure).unwrap(); image::save_buffer(format!("/tmp/out/{name}_{n}.png"), &px, size[0], size[1], image::ColorType::Rgba8).unwrap(); };
        save(&comp.run(&gpu, &inputs, &pics.surface, &pre.scattered).unwrap(), "final");
        save(&pre.scattered, "scattered"); save(&march.scattered, "march"); save(&rows.scattered, "rows"); save(&pics.surface, "surface");
    }
}
