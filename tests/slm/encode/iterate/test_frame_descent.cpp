#include "holotrace/slm/encode/iterate/frame_descent.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "support/panels.h"

namespace holotrace {
namespace {

// Frames that note how each update takes the panel.
class NotedLight : public WavelengthLight {
 public:
  NotedLight(std::unique_ptr<WavelengthLight> light, std::vector<PanelDetail>& details)
      : light_(std::move(light)), details_(details) {}
  void add(const TargetPlane& target) override { light_->add(target); }
  void leave(const PanelDetail& detail) override {
    details_.push_back(detail);
    light_->leave(detail);
  }
  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override {
    return light_->plane_sums(plane, group, is_kept);
  }
  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override {
    return light_->add_gradient(plane, group, scale, factor);
  }
  ModulusSums view_sums(const ViewTargets& views, bool is_kept) override { return light_->view_sums(views, is_kept); }
  double add_gradient_of_views(const ViewTargets& views, double scale, double factor) override {
    return light_->add_gradient_of_views(views, scale, factor);
  }

 private:
  std::unique_ptr<WavelengthLight> light_;
  std::vector<PanelDetail>& details_;
};

class NotedFrames : public ProcessorFrames {
 public:
  using ProcessorFrames::ProcessorFrames;
  std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) override {
    return std::make_unique<NotedLight>(ProcessorFrames::light_of(panel, wavelength), *details);
  }
  std::vector<PanelDetail>* details = nullptr;
};

TEST(FrameDescent, TakesThePanelCoarselyFirstAndAsShownLast) {
  Slm slm = make_panel(32, 24, 256, 0.9);
  slm.effects.crosstalk = 0.2;
  EncodeParams params;
  params.method = Encoding::sgd;
  params.iterations = 8;
  TargetSet targets;
  TargetPlane target;
  target.z = 0.01;
  target.wavelength = test_wavelength;
  target.amplitude = Array2D<float>(24, 32, 1);
  targets.planes.push_back(target);
  const std::vector<Hologram> frames(4, make_hologram(slm, Modulation::phase, [](int i) { return i * 37 % 256; }));
  std::vector<PanelDetail> details;
  auto arrays = std::make_unique<NotedFrames>(slm, params, frames);
  arrays->details = &details;
  const DescentSetup setup{slm, params};
  FrameDescent descent(targets, setup, frames, std::move(arrays));
  while (descent.updates() < params.iterations) descent.update();
  descent.judge();
  ASSERT_EQ(details.size(), 9U);
  for (size_t n = 0; n < 8; ++n) {
    EXPECT_EQ(details[n].light, n < 6 ? PixelDetail::coarse : PixelDetail::as_shown) << n;
    EXPECT_EQ(details[n].slopes, PixelDetail::mean) << n;
  }
  EXPECT_EQ(details[8].light, PixelDetail::as_shown) << "figures are those of what is shown";
}

}  // namespace
}  // namespace holotrace
