//! Every part of a frame that ran is timed, and no other.
#![allow(clippy::unwrap_used)]

mod common;

use common::small_demo;
use glam::UVec2;
use topout_render::{
    Antialias, DrawMode, FrameInput, FrameStats, Gpu, Occlusion, Options, Pass, Renderer,
};
use topout_scene::{Scene, View};

fn input(scene: &Scene, mode: DrawMode) -> FrameInput {
    let view = View::fit(&scene.focus_bounds(), 30.0, 20.0, 2.0, UVec2::new(320, 200));
    FrameInput { view, time: scene.schedule.period.at_fraction(0.6), mode }
}

/// The passes that a side of the machine has a time of.
fn ran(stats: &FrameStats, gpu: bool) -> Vec<Pass> {
    let time = |pass| if gpu { stats.passes[pass].gpu_ms } else { stats.passes[pass].cpu_ms };
    Pass::ALL.map(|(pass, ..)| pass).into_iter().filter(|pass| time(*pass).is_some()).collect()
}

#[test]
fn passes_that_ran_have_times_and_no_others() {
    use Pass::*;
    let (scene, tree) = small_demo(1000);
    let gpu = Gpu::headless().unwrap();
    let copies = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);
    let mut r = Renderer::new(&gpu);
    assert!(r.has_timestamps(), "this test needs an adapter that tells its time");
    r.set_scene(&scene).unwrap();
    r.set_hdlod(&tree).unwrap();
    let (hdlod, batched) = (DrawMode::Hdlod, DrawMode::Batched);
    let (plain, smooth) = (Antialias::Off, Antialias::Smooth);
    let base = r.options();
    let options = |occlusion, antialias, edges| Options { antialias, edges, occlusion, ..base };
    let cases: [(DrawMode, Options, &[Pass], &[Pass]); 4] = [
        (
            hdlod,
            options(Occlusion::Gpu, smooth, 0.3),
            &[Select, Upload, Cull, Scene, Glass, Finish, Submit],
            &[Recall, Occluders, Cull, Scene, Glass, Finish, Copy],
        ),
        (
            hdlod,
            options(Occlusion::Cpu, plain, 0.3),
            &[Select, Upload, Cull, Scene, Glass, Finish, Submit],
            &[Scene, Glass, Finish],
        ),
        (
            hdlod,
            options(Occlusion::Off, plain, 0.0),
            &[Select, Upload, Scene, Glass, Submit],
            &[Scene, Glass],
        ),
        (
            batched,
            options(Occlusion::Gpu, plain, 0.0),
            &[Select, Upload, Scene, Glass, Submit],
            &[Scene, Glass],
        ),
    ];
    for (mode, options, on_cpu, on_gpu) in cases {
        r.set_options(options);
        let mut stats = r.render(&input(&scene, mode));
        assert_eq!(ran(&stats, true), [], "nothing is known of the GPU yet");
        r.wait_idle();
        assert!(r.take_gpu_times().iter().any(|times| stats.add_gpu_times(times)));
        let case = format!("{mode:?} {options:?}");
        assert_eq!(ran(&stats, false), on_cpu, "{case}");
        let on_gpu: Vec<Pass> = on_gpu.iter().copied().filter(|p| copies || *p != Copy).collect();
        assert_eq!(ran(&stats, true), on_gpu, "{case}");

        // The parts are parts of the whole.
        let whole = stats.select_ms + stats.cpu_ms;
        assert!((stats.passes.cpu_ms() - whole).abs() < 1e-9, "{case}");
        let parts: f64 = on_gpu.iter().filter_map(|pass| stats.passes[*pass].gpu_ms).sum();
        assert!(parts > 0.0 && parts <= stats.gpu_ms.unwrap() + 1e-6, "{case}: {stats:?}");
    }
}

/// Frames that are not waited for each get their own times, those of frames too many get none.
#[test]
fn times_find_their_frame() {
    let (scene, _) = small_demo(1000);
    let mut r = Renderer::new(&Gpu::headless().unwrap());
    r.set_scene(&scene).unwrap();
    let input = input(&scene, DrawMode::Batched);
    let mut frames: Vec<FrameStats> = (0..8).map(|_| r.render(&input)).collect();
    assert!(frames.windows(2).all(|w| w[0].frame + 1 == w[1].frame));
    assert!(r.expects_gpu_times());
    r.wait_idle();
    let times = r.take_gpu_times();
    assert!((1..=3).contains(&times.len()), "{times:?}");
    for times in &times {
        let told: Vec<_> =
            frames.iter_mut().filter_map(|f| f.add_gpu_times(times).then_some(f.frame)).collect();
        assert_eq!(told, [times.frame]);
    }
    assert!(!r.expects_gpu_times() && r.take_gpu_times().is_empty());
    assert_eq!(r.gpu_ms(), times.iter().max_by_key(|t| t.frame).map(|t| t.frame_ms));
}
