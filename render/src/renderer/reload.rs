//! Other shaders for a renderer that is at work.

use super::{Passes, Renderer, new_culler};
use crate::cull::Culler;
use crate::gpu::Gpu;
use crate::input::FrameInput;
use crate::shader::{ShaderError, ShaderFolder};

impl Renderer {
    /// Takes the shaders over from their files. They are tried with a frame first: where they are not
    /// valid, or do not fit what the program gives to them, everything stays as it was.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn reload_shaders(
        &mut self,
        folder: &ShaderFolder,
        frame: &FrameInput,
    ) -> Result<(), ShaderError> {
        let device = self.gpu.device.clone();
        let check = |scope: wgpu::ErrorScopeGuard| match pollster::block_on(scope.pop()) {
            Some(error) => Err(ShaderError::Invalid(plain(&error.to_string()))),
            None => Ok(()),
        };
        let gpu = Gpu { shaders: folder.read()?, ..self.gpu.clone() };
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let passes = Passes::new(&gpu, &self.bindings, self.options);
        let culler = new_culler(&gpu, self.options, passes.samples);
        check(scope)?;

        let mut other = (gpu, passes, culler);
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.exchange_shaders(&mut other);
        self.render(frame);
        check(scope).inspect_err(|_| {
            self.exchange_shaders(&mut other);
            self.render(frame);
        })
    }

    fn exchange_shaders(&mut self, (gpu, passes, culler): &mut (Gpu, Passes, Option<Culler>)) {
        std::mem::swap(&mut self.gpu, gpu);
        std::mem::swap(&mut self.passes, passes);
        std::mem::swap(&mut self.culler, culler);
        self.selection.forget_targets();
        self.section.forget_targets();
        self.bind_pictures();
    }
}

/// Without lines drawn by characters, which few fonts have.
fn plain(message: &str) -> String {
    let sign = |c| match c {
        '\u{2502}' => '|',
        '\u{2500}'..='\u{257f}' => '-',
        c => c,
    };
    message.trim().chars().map(sign).collect()
}
