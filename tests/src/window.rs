//! The real application on a software adapter, driven by its accessible names.

#![allow(clippy::unwrap_used, clippy::missing_panics_doc)]

use egui::{Pos2, Rect, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use topout::project::Request;
use topout::window::{AppState, Command, Left, Window};
use topout_scene::demo::{DemoSettings, generate};
use topout_scene::{Progress, Scene, link};
use topout_schedule::Time;

/// 1,000 elements; made once for all cases of this process.
pub fn scene() -> Arc<Scene> {
    static SCENE: OnceLock<Arc<Scene>> = OnceLock::new();
    let make = || {
        let settings =
            DemoSettings { elements: 1_000, triangles: 46_000, activities: 850, seed: 4 };
        let (model, schedule) = generate(&settings, &Progress::default()).unwrap();
        Arc::new(link::link(model, schedule))
    };
    Arc::clone(SCENE.get_or_init(make))
}

/// The window's own device settings, on a software adapter where there is one.
pub fn setup() -> egui_wgpu::WgpuSetup {
    let mut setup = topout::window::wgpu_setup();
    if let egui_wgpu::WgpuSetup::CreateNew(create) = &mut setup {
        create.native_adapter_selector = Some(Arc::new(|adapters, _| {
            let is_cpu = |a: &&egui_wgpu::wgpu::Adapter| {
                a.get_info().device_type == egui_wgpu::wgpu::DeviceType::Cpu
            };
            let chosen = adapters.iter().find(is_cpu).or(adapters.first());
            chosen.cloned().ok_or_else(|| "no graphics adapter".to_owned())
        }));
    }
    setup
}

/// Nothing loaded.
pub fn empty() -> Harness<'static, Window> {
    made_by(|context| Window::new(context, None).unwrap())
}

/// What a window left whose device was lost.
pub fn again(left: Left) -> Harness<'static, Window> {
    made_by(|context| Window::again(context, left).unwrap())
}

fn made_by(
    make: impl FnOnce(&mut eframe::CreationContext<'_>) -> Window,
) -> Harness<'static, Window> {
    Harness::builder()
        .with_size([900.0, 600.0])
        .with_theme(egui::Theme::Dark)
        .with_render_cursor(false)
        .with_step_dt(0.1)
        .with_max_steps(12)
        .wgpu_setup(setup())
        .build_eframe(|context| make(context))
}

/// With the small demo, its tree ready, at the first day of 2027.
pub fn open() -> Harness<'static, Window> {
    open_sized([900.0, 600.0])
}

/// The same in a window of so many points.
pub fn open_sized(size: [f32; 2]) -> Harness<'static, Window> {
    let mut harness = empty();
    harness.set_size(size.into());
    harness.state_mut().state_mut().show_scene(Request::demo(), scene());
    settle(&mut harness);
    apply(&mut harness, Command::JumpTo(Time::parse_iso("2027-01-01").unwrap()));
    harness
}

/// Runs frames until no thread is at work, what every frame took is known and nothing asks for another.
pub fn settle(harness: &mut Harness<'_, Window>) {
    loop {
        while harness.state().is_busy() {
            harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        harness.run();
        if !harness.state().is_busy() {
            return;
        }
    }
}

/// Carries a command out and waits until all is done that it started.
pub fn apply(harness: &mut Harness<'_, Window>, command: Command) {
    apply_now(harness, command);
    settle(harness);
}

/// For commands that start something: does not wait for it.
pub fn apply_now(harness: &mut Harness<'_, Window>, command: Command) {
    harness.state_mut().state_mut().apply(command);
}

/// What the window shows.
pub fn state<'a>(harness: &'a Harness<'_, Window>) -> &'a AppState {
    harness.state().state()
}

/// Where the 3D view is.
pub fn view(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_label("3D view").rect()
}

/// Where the timeline is.
pub fn axis(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_role(Role::Slider).rect()
}

/// Presses at the first point, moves through the others, lets go at the last.
pub fn drag(harness: &mut Harness<'_, Window>, points: &[Pos2]) {
    harness.hover_at(points[0]);
    harness.step();
    harness.drag_at(points[0]);
    harness.step();
    for point in &points[1..] {
        harness.hover_at(*point);
        harness.step();
    }
    harness.drop_at(*points.last().unwrap());
    harness.run();
}

/// The pixels of the 3D view.
pub fn picture(harness: &mut Harness<'_, Window>) -> Vec<u8> {
    let place = view(harness);
    let image = harness.render().unwrap();
    let (x, y) = (place.min.x as u32, place.min.y as u32);
    let (width, height) = (place.width() as u32, place.height() as u32);
    image::imageops::crop_imm(&image, x, y, width, height).to_image().into_raw()
}
