//! An open device: compiling, allocating, submitting and reading back, each with its errors.

use super::GpuError;
use super::adapter::{self, Adapter, Wanted};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long a submission may take. Spans are fractions of a second; a driver that hangs resets the device long before this.
const PATIENCE: Duration = Duration::from_secs(120);

/// Share of the device's free memory that a run may take, percent: an allocation beyond is refused, which is better than a
/// driver that swaps or fails later.
pub(super) const MEMORY_PERCENT: u8 = 95;

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
        let (found, adapter) = adapter::find(wanted, memory_percent)?;
        let request = wgpu::DeviceDescriptor {
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
        // What no scope catches is a consequence of a lost device, which is told of on its own; the default is to panic.
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
        // Scopes are popped in the reverse order; the last error found is the outermost.
        let mut error = None;
        for scope in scopes.into_iter().rev() {
            error = pollster::block_on(scope.pop()).or(error);
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

    /// Compiles the entry points of a shader text, in their order.
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
                        source: wgpu::ShaderSource::Wgsl(text.into()),
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

    /// Submits commands and waits until they are done.
    pub(super) fn submit(&self, commands: wgpu::CommandBuffer) -> Result<(), GpuError> {
        self.checked(
            || {
                self.queue.submit([commands]);
                self.wait()
            },
            |error| self.driver_error(error),
        )?
    }

    fn wait(&self) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(PATIENCE),
        });
        self.alive()?;
        waited
            .map(|_| ())
            .map_err(|error| self.driver_error(format!("{error} after {} s", PATIENCE.as_secs())))
    }

    /// The first words of a buffer, by way of a read-back buffer.
    pub(super) fn read(
        &self,
        from: &wgpu::Buffer,
        by: &wgpu::Buffer,
        words: usize,
    ) -> Result<Vec<u32>, GpuError> {
        let size = bytes(words);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(from, 0, by, 0, size);
        self.submit(encoder.finish())?;
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

/// Bytes of a number of words.
pub(super) fn bytes(words: usize) -> u64 {
    4 * words as u64
}
