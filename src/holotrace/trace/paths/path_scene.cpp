#include "holotrace/trace/paths/path_scene.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "holotrace/base/error.h"
#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

PathScene::PathScene(const Scene& scene, const Lines& lines, const std::vector<std::string>& path_expressions,
                     const PathParams& params)
    : scene(scene),
      accelerator(scene, params.accelerator),
      emitters(scene, lines),
      automaton(path_expressions),
      lines(lines),
      params(params),
      rectangles(scene.lights.size()),
      mirrors(flat_mirrors(scene, emitters.lights(), lines)),
      has_panes(std::any_of(scene.meshes.begin(), scene.meshes.end(),
                            [&](const Mesh& mesh) { return is_pane(scene.materials[size_t(mesh.material)]); })) {
  require(params.max_depth >= 1, "expected a max_depth of 1 surface or more, got {}", params.max_depth);
  require(params.roulette_depth >= 1, "expected a roulette_depth of 1 surface or more, got {}", params.roulette_depth);
  require(std::isfinite(params.clamp) && params.clamp >= 0, "expected a clamp of 0 W/m²/sr or more, got {}",
          params.clamp);
  for (size_t i = 0; i < rectangles.size(); ++i)
    if (const auto* rectangle = std::get_if<RectangleLight>(&emitters.lights()[i]))
      rectangles[i] = lanes_of(*rectangle, accelerator.lift_of(int(i)));
  caustics = find_caustics(*this, params.caustic_rays);
}

}  // namespace holotrace
