// Runs whose stages are all on one device: what its memory holds, what returns, and what a run says if the device fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/pipeline.h"
#include "support/build_paths.h"
#include "support/stages_on_devices.h"
#include "support/temporary.h"
#if HOLOTRACE_HAS_OPENCL
#include "holotrace/opencl/api.h"
#endif

namespace holotrace::test {
namespace {

#if HOLOTRACE_HAS_OPENCL

// A square in front of the panel, whose light is waves.
constexpr const char* scene = R"([slm]
columns = 160
rows = 90
pitch = "8 um"
[trace]
columns = 16
rows = 9
field_of_view = "1.1 deg"
paths = 1
[synthesize]
method = "tiled"
[encode]
method = "phase"
[render]
columns = 16
rows = 9
paths = 2
[camera]
distances = "20 mm"
[[light]]
type = "rectangle"
corner = "-5 -5 5 mm"
edge_u = "0 10 0 mm"
edge_v = "10 0 0 mm"
radiance = 5
[[object]]
type = "quad"
width = "0.5 mm"
height = "0.45 mm"
position = "0 0 -20 mm"
)";
constexpr size_t field_bytes = 8 * 160 * 90;

// Watches the memory of a device, and the fields that return from it, whose transfer fails if it is told to.
class Watch {
 public:
  explicit Watch(Device& watched) : true_api_(opencl_api()) {
    self = this;
    device = &watched;
    opencl_api().clCreateBuffer = [](cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* status) {
      self->most_held = std::max(self->most_held, self->device->use().bytes_held + size);
      return self->true_api_.clCreateBuffer(context, flags, size, host, status);
    };
    opencl_api().clEnqueueReadBuffer = [](cl_command_queue queue, cl_mem buffer, cl_bool waits, size_t from,
                                          size_t size, auto... others) {
      const bool is_field = size == field_bytes;
      self->fields += is_field;
      if (is_field) self->most_held = 0;
      if (is_field && self->fails) return cl_int(CL_DEVICE_NOT_AVAILABLE);
      return self->true_api_.clEnqueueReadBuffer(queue, buffer, waits, from, size, others...);
    };
  }
  ~Watch() { opencl_api() = true_api_; }
  Watch(const Watch&) = delete;

  size_t most_held = 0;  ///< bytes, since a field was fetched
  int fields = 0;        ///< that were fetched
  bool fails = false;

 private:
  OpenClApi true_api_;
  Device* device;
  inline static Watch* self = nullptr;
};

class RunsOnDevices : public StagesOnDevices {
 protected:
  RunsOnDevices() { limit_device_propagators(0); }  // memory is that of the fields and of the stages' work
  ~RunsOnDevices() override { limit_device_propagators(std::numeric_limits<double>::infinity()); }

  static Job job_of(std::vector<double> wavelengths, const DeviceChoice& device) {
    Job job = load_job(make_file("scene.toml", "wavelength = \"532 nm\"\n" + std::string(scene)));
    job.wavelengths = std::move(wavelengths);
    job.synthesize.device = job.encode.device = job.show.device = job.propagate.device = device;
    return job;
  }
  DeviceChoice here() const { return {DeviceKind::opencl, device_.info().number}; }
};

HOLOTRACE_FOR_ALL_DEVICES(RunsOnDevices);

// After the last field has returned, six fields are encoded. What shows a hologram holds more than six fields and
// the levels of one: 56 bytes per pixel for the panel, and tables of rows and columns; the propagation more.
TEST_P(RunsOnDevices, HoldNoFieldWhileHologramsAreShown) {
  const auto most_held = [&](const std::vector<double>& wavelengths) {
    const Watch watch(device_);
    run(job_of(wavelengths, here()));
    return watch.most_held - device_.use().bytes_held;
  };
  const std::vector<double> six{532e-9, 450e-9, 638e-9, 500e-9, 560e-9, 600e-9};
  size_t one = 0;
  for (const double wavelength : six) one = std::max(one, most_held({wavelength}));
  ASSERT_GT(one, 7 * field_bytes);
  EXPECT_LE(most_held(six), one);
}

TEST_P(RunsOnDevices, FetchTheFieldsOfTheFirstFrame) {
  Job job = job_of({532e-9, 638e-9}, here());
  job.trace.frames = 2;
  Watch watch(device_);
  const RunResults results = run(job);
  EXPECT_EQ(watch.fields, 2);
  ASSERT_EQ(results.fields.size(), 1u);
  ASSERT_EQ(results.fields[0].size(), 2u);
  EXPECT_EQ(results.holograms.size(), 4u);
  job.synthesize.device = {};
  const RunResults expected = run(job);
  for (size_t i = 0; i < 2; ++i) {
    const Array2D<std::complex<float>>&a = results.fields[0][i].samples, &b = expected.fields[0][i].samples;
    double error = 0, norm = 0;
    for (size_t k = 0; k < b.size(); ++k) {
      error += std::norm(a.values[k] - b.values[k]);
      norm += std::norm(b.values[k]);
    }
    EXPECT_LT(error, 4e-6 * norm) << "both sums are within the tolerance of 1e-3";
  }
}

TEST_P(RunsOnDevices, SayThatAFieldIsSummedAgain) {
  SummationRates slow;
  slow.multiply_adds = slow.factors = slow.wave_tiles = 1e3;
  slow.samples = 1e4;
  set_summation_rates([slow] { return slow; });
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{1e15, 1e15, 1e15} : DeviceRates();
  });
  const Job job = job_of({532e-9}, {DeviceKind::automatic});
  Job on_processor = job_of({532e-9}, {});
  Watch watch(device_);
  watch.fails = true;
  const RunResults results = run(job);
  EXPECT_EQ(watch.fields, 1);
  EXPECT_EQ(results.fields.at(0).at(0).samples.values, run(on_processor).fields.at(0).at(0).samples.values);
  const auto stage = std::find_if(results.report.stages.begin(), results.report.stages.end(),
                                  [](const StageReport& s) { return s.stage == "synthesize"; });
  ASSERT_NE(stage, results.report.stages.end());
  ASSERT_EQ(stage->warnings.size(), 1u);
  EXPECT_EQ(stage->warnings[0].find("the device auto: the processor took over, because the device "), 0u);
}

#endif

}  // namespace
}  // namespace holotrace::test
