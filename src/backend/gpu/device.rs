//! An open device: compiling, allocating, submitting and reading back, each with its errors.

use super::GpuError;
use super::adapter::{self, Adapter, MEMORY_PERCENT, Wanted};
use super::unrolling::unrolled;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long a submission may take. Spans are fractions of a second; a driver that hangs resets the device long before
/// this.
const PATIENCE: Duration = Duration::from_secs(120);

/// Words that are on their way to the device at once: what waits for the next submission lies in memory that the device
/// can map, which is small on some cards.
const UPLOAD: usize = 4 << 20;

/// An open device.
pub struct Gpu {
    adapter: Adapter,
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    /// Why the device was lost, if it was.
    lost: Arc<Mutex<Option<String>>>,
}

/// Something that a buffer is for.
#[derive(Clone, Copy)]
pub(super) enum Use {
    Uniform,
    Storage,
    ReadBack,
}

impl Gpu {
    /// Opens the adapter that is wanted, with all the limits that it has.
    ///
    /// # Errors
    /// If there is none, or its driver gives no device.
    pub fn open(wanted: Wanted<'_>) -> Result<Self, GpuError> {
        Self::open_within(wanted, MEMORY_PERCENT)
    }

    /// The same with another share of the device's memory, percent, beyond which allocations fail.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    #[doc(hidden)]
    pub fn open_within(wanted: Wanted<'_>, memory_percent: u8) -> Result<Self, GpuError> {
        let mut refused = None;
        for (found, adapter) in adapter::find(wanted, memory_percent)? {
            match Self::open_adapter(&found, adapter) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.unwrap_or(GpuError::NoHardware { found: Vec::new() }))
    }

    fn open_adapter(found: &wgpu::Adapter, adapter: Adapter) -> Result<Self, GpuError> {
        let request = wgpu::DeviceDescriptor {
            required_features: found.features() & wgpu::Features::SHADER_INT64,
            required_limits: found.limits(),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) =
            pollster::block_on(found.request_device(&request)).map_err(|error| {
                GpuError::NoDevice {
                    adapter: adapter.name.clone(),
                    reason: error.to_string(),
                }
            })?;
        let lost = Arc::new(Mutex::new(None));
        let told = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            let message = format!("{reason:?}: {message}");
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
        });
        // All work is done in scopes; what comes outside of them, when buffers are dropped on a lost device, would
        // panic.
        device.on_uncaptured_error(Arc::new(|_| ()));
        Ok(Self {
            adapter,
            device,
            queue,
            lost,
        })
    }

    /// The adapter.
    #[must_use]
    pub fn adapter(&self) -> &Adapter {
        &self.adapter
    }

    /// Gives the device up, as if its driver had reset it: everything that follows fails with [`GpuError::Lost`].
    pub fn destroy(&self) {
        self.device.destroy();
    }

    /// Whether shaders may have 64-bit integers.
    pub(crate) fn has_int64(&self) -> bool {
        self.device
            .features()
            .contains(wgpu::Features::SHADER_INT64)
    }

    /// The limits of the device.
    pub(super) fn limits(&self) -> wgpu::Limits {
        self.device.limits()
    }

    /// Does something, and tells what went wrong.
    pub(super) fn checked<T>(
        &self,
        work: impl FnOnce() -> T,
        failed: impl FnOnce(wgpu::Error) -> GpuError,
    ) -> Result<T, GpuError> {
        let scopes = [
            wgpu::ErrorFilter::Internal,
            wgpu::ErrorFilter::Validation,
            wgpu::ErrorFilter::OutOfMemory,
        ]
        .map(|filter| self.device.push_error_scope(filter));
        let done = work();
        // Scopes are popped in the reverse order. A buffer for which there is no memory is invalid wherever it is
        // bound, so that lack of memory, which is popped first, is the cause of what else went wrong.
        let mut error = None;
        for scope in scopes.into_iter().rev() {
            let popped = pollster::block_on(scope.pop());
            error = error.or(popped);
        }
        if error.is_some() {
            // A loss is told of when the device is polled.
            self.poll(wgpu::PollType::Poll).ok();
        }
        self.alive()?;
        error.map_or(Ok(done), |error| Err(failed(error)))
    }

    /// Whether the device is still there.
    pub(super) fn alive(&self) -> Result<(), GpuError> {
        let lost = self.lost.lock().unwrap_or_else(PoisonError::into_inner);
        match lost.as_ref() {
            None => Ok(()),
            Some(reason) => Err(GpuError::Lost {
                adapter: self.adapter.name.clone(),
                reason: reason.clone(),
            }),
        }
    }

    pub(super) fn driver_error(&self, reason: impl ToString) -> GpuError {
        GpuError::Driver {
            adapter: self.adapter.name.clone(),
            reason: reason.to_string(),
        }
    }

    /// Compiles the entry points of a shader text, whose loops are written out first, in their order.
    pub(super) fn compile<const N: usize>(
        &self,
        text: &str,
        layout: &wgpu::BindGroupLayout,
        entries: [&'static str; N],
    ) -> Result<[wgpu::ComputePipeline; N], GpuError> {
        self.checked(
            || {
                let module = self
                    .device
                    .create_shader_module(wgpu::ShaderModuleDescriptor {
                        label: None,
                        source: wgpu::ShaderSource::Wgsl(unrolled(text).into()),
                    });
                let layout = self
                    .device
                    .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                        bind_group_layouts: &[Some(layout)],
                        ..wgpu::PipelineLayoutDescriptor::default()
                    });
                entries.map(|entry| {
                    self.device
                        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                            label: Some(entry),
                            layout: Some(&layout),
                            module: &module,
                            entry_point: Some(entry),
                            compilation_options: wgpu::PipelineCompilationOptions::default(),
                            cache: None,
                        })
                })
            },
            |error| GpuError::Shader {
                adapter: self.adapter.name.clone(),
                reason: error.to_string(),
            },
        )
    }

    /// A buffer of at least one word.
    pub(super) fn buffer(&self, words: usize, usage: Use) -> wgpu::Buffer {
        use wgpu::BufferUsages as Usages;
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes(words.max(4)),
            usage: match usage {
                Use::Uniform => Usages::UNIFORM | Usages::COPY_DST,
                Use::Storage => Usages::STORAGE | Usages::COPY_DST | Usages::COPY_SRC,
                Use::ReadBack => Usages::MAP_READ | Usages::COPY_DST,
            },
            mapped_at_creation: false,
        })
    }

    /// Writes words to a buffer, piece by piece, so that little of them waits in mapped memory.
    pub(super) fn upload(&self, buffer: &wgpu::Buffer, words: &[u32]) -> Result<(), GpuError> {
        for (k, piece) in words.chunks(UPLOAD).enumerate() {
            self.write(buffer, bytes(k * UPLOAD), piece)?;
            self.submit(|_| ())?;
        }
        Ok(())
    }

    /// Writes to a buffer, before whatever is submitted next.
    pub(super) fn write<T: bytemuck::NoUninit>(
        &self,
        buffer: &wgpu::Buffer,
        offset: u64,
        values: &[T],
    ) -> Result<(), GpuError> {
        self.checked(
            || {
                let bytes = bytemuck::cast_slice(values);
                self.queue.write_buffer(buffer, offset, bytes);
            },
            |error| self.driver_error(error),
        )
    }

    /// Records commands, submits them and waits until they are done.
    pub(super) fn submit(
        &self,
        record: impl FnOnce(&mut wgpu::CommandEncoder),
    ) -> Result<(), GpuError> {
        self.checked(
            || {
                let mut encoder = self
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                record(&mut encoder);
                self.queue.submit([encoder.finish()]);
                self.wait()
            },
            |error| self.driver_error(error),
        )?
    }

    fn wait(&self) -> Result<(), GpuError> {
        self.alive()?;
        self.poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(PATIENCE),
        })
    }

    fn poll(&self, poll: wgpu::PollType) -> Result<(), GpuError> {
        let polled = lost_if_panics(|| self.device.poll(poll).map_err(|error| error.to_string()));
        self.alive()?;
        match polled {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(self.driver_error(error)),
            Err(reason) => {
                *self.lost.lock().unwrap_or_else(PoisonError::into_inner) = Some(reason);
                self.alive()
            }
        }
    }

    /// The first words of a buffer, by way of a read-back buffer.
    pub(super) fn read(
        &self,
        from: &wgpu::Buffer,
        by: &wgpu::Buffer,
        words: usize,
    ) -> Result<Vec<u32>, GpuError> {
        let size = bytes(words);
        self.submit(|encoder| encoder.copy_buffer_to_buffer(from, 0, by, 0, size))?;
        let mapped = Arc::new(Mutex::new(None));
        let told = Arc::clone(&mapped);
        by.map_async(wgpu::MapMode::Read, 0..size, move |result| {
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        self.wait()?;
        let mapped = mapped.lock().unwrap_or_else(PoisonError::into_inner).take();
        match mapped {
            Some(Ok(())) => {}
            Some(Err(error)) => return Err(self.driver_error(error)),
            None => return Err(self.driver_error("a result cannot be read back")),
        }
        let view = by
            .get_mapped_range(0..size)
            .map_err(|error| self.driver_error(error))?;
        let read = bytemuck::pod_collect_to_vec(&view);
        drop(view);
        by.unmap();
        Ok(read)
    }
}

/// Does something that panics if the driver has lost the device: wgpu knows no other way to tell of it while it waits.
fn lost_if_panics<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or(panic.downcast_ref::<&str>().copied());
        text.unwrap_or("the driver gave no reason").to_string()
    })
}

/// Bytes of a number of words.
pub(super) fn bytes(words: usize) -> u64 {
    4 * words as u64
}

#[cfg(test)]
mod tests {
    use super::lost_if_panics;

    #[test]
    fn a_panic_while_waiting_becomes_a_reason() {
        assert_eq!(lost_if_panics(|| 3), Ok(3));
        let lost = lost_if_panics(|| -> u32 { panic!("parent device is {}", "lost") });
        assert_eq!(lost, Err("parent device is lost".to_string()));
    }
}
