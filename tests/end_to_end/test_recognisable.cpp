// A textured, lit model through the whole chain: the hologram's view is the picture that a lens with the panel's area
// would give. It is sharp in focus, and better with more frames.

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "end_to_end/scenes.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "support/data_files.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A square panel of 2 mm: at 60 mm its grain λd/S is 16 µm, half of a sensor pixel of 4 panel pixels. A plane 10 mm
// behind the focus is blurred by 2.05·10/70 = 0.29 mm.
const Grid square_panel{256, 256, 8e-6};
constexpr double depth = 60e-3;

// Squares of four shades, 4 × 4 on a face, each different from its neighbours; a face is 1.1 mm wide, a square 0.28 mm.
void write_textured_box(const Workplace& work) {
  const float shades[4] = {0.05F, 1, 0.35F, 0.7F};
  Image texture(64, 64, 1);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) texture(j, i) = shades[(i / 16 + 2 * (j / 16) + (j / 32)) % 4];
  save_image(work.path("rooms.png"), texture, 1, 8);
  work.write("box.mtl", "newmtl rooms\nKd 1 1 1\nmap_Kd rooms.png\n");
  std::string obj = "mtllib box.mtl\nusemtl rooms\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  for (int k = 0; k < 8; ++k) obj += fmt::format("v {} {} {}\n", k & 1, k >> 1 & 1, k >> 2);
  for (const char* face : {"5 6 8 7", "2 1 3 4", "6 2 4 8", "1 5 7 3", "7 8 4 3", "1 2 6 5"}) {  // seen from outside
    int corner = 0;
    obj += "f";
    for (const char* c = face; *c; c += c[1] ? 2 : 1) obj += fmt::format(" {}/{}", *c, ++corner);
    obj += "\n";
  }
  work.write("box.obj", obj);
}

double half_tangent(const Job& job) { return acceptance_tangent(job.wavelengths[0], job.slm.grid.pitch); }

Job model_job(const Workplace& work, const std::string& file) {
  const std::string path = work.write(
      "scene.toml", scene_head(square_panel, "background = 0.25\n") +
                        "[trace]\ncolumns = 192\nrows = 192\npaths = 16\nmax_depth = 3\nframes = 8\n"
                        "field_of_view = \"0.95 deg\"\n"  // 1 mm at 60 mm
                        "[render]\nrows = 256\npaths = 64\nmax_depth = 3\nlens = \"panel\"\nlayers = \"ED.*L\"\n"
                        "[camera]\ndistances = \"60 70 mm\"\nbinning = 4\n"
                        "[[light]]\ntype = \"point\"\nposition = \"-20 30 -20 mm\"\nintensity = 5e-3\n"
                        "[[object]]\ntype = \"mesh\"\nfit = \"1.1 mm\"\ndistance = \"60 mm\"\n"
                        "rotation = [\"y 30 deg\", \"x 20 deg\"]\nfile = \"" +
                        file + "\"\n");
  Job job = load_job(path);
  job.render.field_of_view = std::atan(half_tangent(job));
  return job;
}

void expect_recognised(const Job& job) {
  const RunResults results = run(job);
  ASSERT_EQ(results.views.size(), 2u);
  // The picture in focus, at the same tangents on both sensors. Out of focus it would only be blurred.
  const Image picture = seen_at(results.renders.at(0), job.wavelengths);
  const Image reference = project_render(picture, half_tangent(job), results.views[0], 60e-3);
  const Metrics sharp = compare(reference, results.views[0]);
  const Metrics blurred =
      compare(project_render(picture, half_tangent(job), results.views[1], 70e-3), results.views[1]);
  testing::Test::RecordProperty("metrics", fmt::format("sharp {:.2f} dB, {:.3f}; blurred {:.2f} dB, {:.3f}", sharp.psnr,
                                                       sharp.ssim, blurred.psnr, blurred.ssim));
  // Speckle remains: a bin of 2.05 grains averages 2.6² of them (their autocorrelation is sinc²), with 8 frames
  // 53: an error of I/√53 at a pixel of I. 2 dB less allow for the edges and for the kinoform, which loses the
  // modulus of the field.
  double squares = 0;
  float most = 0;
  for (const float value : reference.values) {
    squares += double(value) * value / double(reference.values.size());
    most = std::max(most, value);
  }
  EXPECT_GT(sharp.psnr, 10 * std::log10(double(most) * most / (squares / 53)) - 2);
  // Out of focus the squares of 0.28 mm blend: the error is their contrast, not a seventh of it.
  EXPECT_GT(sharp.psnr, blurred.psnr + 6);
  EXPECT_GT(sharp.ssim, 0.7);
  EXPECT_LT(blurred.ssim, 0.35);
}

TEST(Recognisable, ATexturedBoxAtItsFocus) {
  const Workplace work;
  write_textured_box(work);
  expect_recognised(model_job(work, "box.obj"));
}

TEST(Recognisable, ATexturedModelOfAFile) {
  const Workplace work;
  expect_recognised(model_job(work, data_file("textured_box.glb")));
}

TEST(Recognisable, BetterWithMoreFrames) {
  const Workplace work;
  write_textured_box(work);
  const Job job = model_job(work, "box.obj");
  RenderParams as_lens = job.render;
  as_lens.focus = depth;
  const Image picture = render(job.scene, job.slm.grid, test_wavelength, as_lens);
  const std::vector<Sources> sources = trace(job.scene, job.slm.grid, job.wavelengths, job.trace);
  CameraParams camera = job.camera;
  camera.binning = 1;
  camera.sampling = PixelSampling::point;  // all the speckle: integrating pixels would average some of it
  CombinedViews by_field, by_hologram;
  std::vector<double> of_field, of_hologram;
  for (uint32_t frame = 0; frame < 16; ++frame) {
    const Field field = fields_of_frame({sources, {}}, frame, job.slm.grid, {}).front();
    by_field.add(test_wavelength, "", 1, look(field, job.slm, depth, {}, camera));
    const Hologram hologram = encode(field, job.slm, {});
    by_hologram.add(test_wavelength, "", hologram.illumination,
                    look(show(hologram, job.slm, {}), job.slm, depth, {}, camera));
    if (const uint32_t frames = frame + 1; frames == 1 || frames == 4 || frames == 16) {
      const Image view = by_field.image();
      const Image reference = project_render(seen_at(picture, job.wavelengths), half_tangent(job), view, depth);
      of_field.push_back(compare(reference, view).psnr);
      of_hologram.push_back(compare(reference, by_hologram.image()).psnr);
    }
  }
  RecordProperty("psnr",
                 fmt::format("field {:.2f}, hologram {:.2f}", fmt::join(of_field, " "), fmt::join(of_hologram, " ")));
  // Speckle of M frames has the variance I²/M. At the best scale, 1/(1 + 1/M), the remaining error is
  // I²/(M + 1): from 1 to 4 frames 10·log₁₀(5/2) = 3.98 dB are gained, from 4 to 16 10·log₁₀(17/5) = 5.31 dB. The
  // picture has about 4000 grains, so the mean of a frame's squares has an error of √(20/4000) = 7 %, 0.3 dB.
  EXPECT_NEAR(of_field[1] - of_field[0], 3.98, 0.5);
  EXPECT_NEAR(of_field[2] - of_field[1], 5.31, 0.5);
  // The kinoform's own noise has random phases, too, and falls in the same way, except for its mean.
  EXPECT_NEAR(of_hologram[1] - of_hologram[0], 3.98, 1);
  EXPECT_NEAR(of_hologram[2] - of_hologram[1], 5.31, 1);
}

}  // namespace
}  // namespace holotrace::test
