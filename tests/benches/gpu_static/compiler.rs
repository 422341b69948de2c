//! Mesa's compiler for AMD's cards, on hardware that is not there. It is called in a process of its own, since the
//! family and the driver are chosen by the environment, and since the null device does not end well.

#![allow(
    unsafe_code,
    reason = "Vulkan is called directly: wgpu opens no device without queues"
)]

use ash::vk;
use std::ffi::CStr;
use std::path::Path;
use std::process::{Command, ExitCode};

/// RDNA 2 (RX 6900). Debian 12's Mesa (22.3) knows RDNA 3, but gives it 132 registers and spills the rest, which later
/// ones do not.
pub(crate) const FAMILIES: [&str; 1] = ["navi21"];
/// What the bindings of shaders/episode.wgsl are: uniform, uniform with an offset, storage.
const BINDINGS: &str = "udssss";
const DRIVER: &str = "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json";

/// What a compiler says of a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Figures([u64; 6]);

impl Figures {
    pub(crate) const NAMES: [&str; 6] = [
        "VGPRs",
        "Spilled VGPRs",
        "Spilled SGPRs",
        "LDS size",
        "Subgroups per SIMD",
        "Instructions",
    ];

    pub(crate) fn of(numbers: &[u64]) -> Option<Self> {
        Some(Self(numbers.try_into().ok()?))
    }

    pub(crate) fn numbers(&self) -> [u64; 6] {
        self.0
    }

    /// Vector registers that go to memory. Scalar ones that do not fit go to vector registers.
    pub(crate) fn spilled(&self) -> u64 {
        self.0[1]
    }

    /// What is worse than before by more than a factor.
    #[allow(clippy::cast_precision_loss, reason = "small numbers")]
    pub(crate) fn grown(&self, before: &Self, factor: f64) -> Vec<String> {
        let pairs = Self::NAMES.iter().zip(self.0.iter().zip(before.0));
        let worse = pairs.filter(|(name, (now, before))| {
            let [now, before] = [**now as f64, *before as f64];
            match **name {
                // Of waves, more are better.
                "Subgroups per SIMD" => now * factor < before,
                _ => now > before * factor,
            }
        });
        worse
            .map(|(name, (now, before))| format!("{name} {now}, {before} before"))
            .collect()
    }
}

/// What the compiler makes of a shader for a family, and its version.
pub(crate) fn compiled(file: &Path, family: &str) -> (String, Figures) {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.arg("compile").arg(file).arg(BINDINGS);
    for name in ["RADV_FORCE_FAMILY", "AMD_FORCE_FAMILY"] {
        command.env(name, family);
    }
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, DRIVER);
    }
    let said = command.env("NODEVICE_SELECT", "1").output().unwrap();
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    let line = |name: &str| {
        let value = text
            .lines()
            .find_map(|line| line.strip_prefix(name)?.strip_prefix('\t'));
        value.unwrap_or_else(|| {
            panic!(
                "{family}: no {name:?} in {text}{}",
                String::from_utf8_lossy(&said.stderr)
            )
        })
    };
    let numbers = Figures::NAMES.map(|name| line(name).parse().unwrap());
    (line("Driver").to_string(), Figures(numbers))
}

/// Compiles `advance` of a file and prints what the driver says of it.
pub(crate) fn compile(file: &Path, bindings: &str) -> ExitCode {
    let bytes = std::fs::read(file).unwrap();
    let words = bytes
        .chunks_exact(4)
        .map(|own| u32::from_le_bytes(own.try_into().unwrap()));
    let words: Vec<u32> = words.collect();
    // Nothing is handed over that does not outlive the call.
    unsafe { print_statistics(&words, bindings) }.unwrap();
    ExitCode::SUCCESS
}

unsafe fn print_statistics(words: &[u32], bindings: &str) -> Result<(), vk::Result> {
    unsafe {
        let entry = ash::Entry::load().expect("a Vulkan loader");
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let instance = vk::InstanceCreateInfo::default().application_info(&application);
        let instance = entry.create_instance(&instance, None)?;
        let physical = instance.enumerate_physical_devices()?[0];
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        instance.get_physical_device_properties2(physical, &mut properties);
        println!("Driver\t{}", text(&driver.driver_info));

        let device = device(&instance, physical)?;
        let module = vk::ShaderModuleCreateInfo::default().code(words);
        let module = device.create_shader_module(&module, None)?;
        let pipeline = pipeline(&device, module, bindings)?;
        let told = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
        let executable = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline);
        for statistic in told.get_pipeline_executable_statistics(&executable)? {
            println!("{}\t{}", text(&statistic.name), statistic.value.u64);
        }
        Ok(())
    }
}

/// A device with what wgpu asks for.
unsafe fn device(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
) -> Result<ash::Device, vk::Result> {
    let mut executables = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
        .pipeline_executable_info(true);
    let mut robust =
        vk::PhysicalDeviceRobustness2FeaturesEXT::default().robust_buffer_access2(true);
    let mut memory = vk::PhysicalDeviceVulkan12Features::default()
        .vulkan_memory_model(true)
        .vulkan_memory_model_device_scope(true);
    let mut zeroed =
        vk::PhysicalDeviceVulkan13Features::default().shader_zero_initialize_workgroup_memory(true);
    let features = vk::PhysicalDeviceFeatures::default().robust_buffer_access(true);
    let extensions = [
        ash::khr::pipeline_executable_properties::NAME.as_ptr(),
        ash::ext::robustness2::NAME.as_ptr(),
    ];
    let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
    let wanted = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&extensions)
        .enabled_features(&features)
        .push_next(&mut executables)
        .push_next(&mut robust)
        .push_next(&mut memory)
        .push_next(&mut zeroed);
    unsafe { instance.create_device(physical, &wanted, None) }
}

/// The pipeline of `advance`, of which the driver keeps its statistics.
unsafe fn pipeline(
    device: &ash::Device,
    module: vk::ShaderModule,
    bindings: &str,
) -> Result<vk::Pipeline, vk::Result> {
    let bindings = (0..).zip(bindings.chars()).map(|(binding, kind)| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(binding)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .descriptor_type(match kind {
                'u' => vk::DescriptorType::UNIFORM_BUFFER,
                'd' => vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC,
                _ => vk::DescriptorType::STORAGE_BUFFER,
            })
    });
    let bindings: Vec<_> = bindings.collect();
    let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    unsafe {
        let sets = [device.create_descriptor_set_layout(&set, None)?];
        let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        let layout = device.create_pipeline_layout(&layout, None)?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"advance");
        let wanted = vk::ComputePipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
            .stage(stage)
            .layout(layout);
        let made = device.create_compute_pipelines(vk::PipelineCache::null(), &[wanted], None);
        Ok(made.map_err(|(_, error)| error)?[0])
    }
}

/// A text in a fixed number of bytes.
fn text(letters: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = letters
        .iter()
        .map(|letter| letter.cast_unsigned())
        .collect();
    let text = CStr::from_bytes_until_nul(&bytes).map(CStr::to_string_lossy);
    text.map(|text| text.into_owned()).unwrap_or_default()
}
