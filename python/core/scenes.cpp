// Scenes, and the verbs that trace them: render, focal_stack, trace, fields, run.

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.h"
#include "holotrace/data/job.h"
#include "holotrace/io/scene/eye_track_file.h"
#include "holotrace/io/scene/model_job.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/io/scene/scene_tables.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/stereo.h"
#include "nouns.h"
#include "params.h"
#include "tables.h"
#include "watch.h"

namespace holotrace::python {
namespace {

Outside outside_of(bool allow) { return allow ? Outside::allowed : Outside::refused; }

std::optional<double> seconds_of(nb::handle time) {
  if (time.is_none()) return std::nullopt;
  return to_time(time, "time");
}

// The shutter that is given, "20 ms", "180 deg" or seconds, or else that of the scene.
Shutter shutter_of(nb::handle given, const Job& job) {
  if (given.is_none()) return job.shutter;
  if (nb::isinstance<nb::str>(given)) return parse_shutter(nb::cast<std::string>(given));
  const double seconds = to_time(given, "shutter");
  require(seconds >= 0, "expected a shutter of 0 s or more, got {:g} s", seconds);
  return {seconds, 0};
}

// The parameters of a stage of a job, by the name of its table in a scene file.
template <class Use>
void with_stage(Job& job, const std::string& stage, const Use& use) {
  if (stage == "trace") return use(job.trace);
  if (stage == "render") return use(job.render);
  if (stage == "synthesize") return use(job.synthesize);
  if (stage == "encode") return use(job.encode);
  if (stage == "show") return use(job.show);
  if (stage == "propagate") return use(job.propagate);
  if (stage == "camera") return use(job.camera);
  if (stage == "animate") return use(job.animate);
  if (stage == "eye") return use(job.eye);
  throw Error(unknown_name_message(
      "stage", stage, {"trace", "render", "synthesize", "encode", "show", "propagate", "camera", "animate", "eye"}));
}

// The parameters of renders of a job, with those that are given in their place.
RenderParams render_params(Job job, const nb::dict& given) {
  set_params(given, job.render);
  return choose_missing(std::move(job), Goal::waves).render;
}

// The observer of a stage that traces a scene, which hears of one without light.
const Observer& tracing(const Job& job, const Observer& observer) {
  if (!has_light(job.scene)) observer.warn(no_light);
  return observer;
}

Image render_scene(const Job& job, const nb::dict& given, Watch& watch) {
  const RenderParams params = render_params(job, given);
  return watch.run("render", [&](const Observer& observer) {
    return make_picture(job, params, PictureUse::radiance, tracing(job, observer));
  });
}

// Left and right.
std::vector<Image> render_pair(const Job& job, const nb::dict& given, Watch& watch) {
  const RenderParams params = render_params(job, given);
  const auto eyes = stereo_pair(params);
  std::vector<Image> pair;
  for (size_t i = 0; i < eyes.size(); ++i)
    pair.push_back(watch.run(i == 0 ? "left eye" : "right eye", [&](const Observer& observer) {
      return make_picture(job, eyes[i], PictureUse::radiance, tracing(job, observer));
    }));
  return pair;
}

FocalStack trace_stack(const Job& job, const std::vector<double>& distances, const nb::dict& given, Watch& watch) {
  RenderParams params = job.render;
  set_params(given, params);
  return watch.run("focal stack", [&](const Observer& observer) {
    return make_focal_stack(job, distances, params, PictureUse::radiance, tracing(job, observer));
  });
}

std::vector<Sources> trace_sources(const Job& given_job, const nb::dict& given, Watch& watch) {
  Job job = given_job;
  set_params(given, job.trace);
  job = choose_missing(std::move(job), Goal::waves);
  return watch.run("trace", [&](const Observer& observer) {
    return trace(job.scene, job.slm.grid, job.wavelengths, job.trace, tracing(job, observer));
  });
}

// As `holotrace field`: the waves are traced and summed.
std::vector<Field> fields_of_scene(const Job& given_job, const nb::dict& given, uint32_t frame, Watch& watch) {
  Job job = given_job;
  set_params(given, job.synthesize);
  job = choose_missing(std::move(job), Goal::waves);
  return watch.run("trace", [&](const Observer& observer) {
    const SceneLight light = trace_light(job, tracing(job, observer));
    return fields_of_frame(light, frame, job.slm.grid, job.synthesize, watch.observer("synthesize"));
  });
}

}  // namespace

void bind_scenes(nb::module_& module) {
  nb::class_<Job> job(module, "Job");
  bind_bytes<Job>(job);
  job.def_static(
      "load",
      [](const std::string& path, bool allow_outside, nb::handle time, nb::handle shutter,
         const std::map<std::string, std::string>& texts, const std::optional<Slm>& slm) {
        std::vector<SceneEdit> edits;
        for (const auto& [key, value] : texts) edits.push_back({key, value});
        const auto at = [&](std::optional<double> t) {
          return load_job_for(slm, path, outside_of(allow_outside), {}, t, edits);
        };
        Job opened = at(seconds_of(time));
        const double seconds = shutter_of(shutter, opened).seconds_at(opened.animate.fps);
        const nb::gil_scoped_release release;
        return open_shutter(std::move(opened), seconds, at);
      },
      nb::arg("path"), nb::arg("allow_outside"), nb::arg("time").none(), nb::arg("shutter").none(), nb::arg("edits"),
      nb::arg("slm").none());
  job.def_static(
      "make",
      [](const nb::dict& dict, bool allow_outside, nb::handle time, nb::handle shutter) {
        SceneArrays arrays;
        const toml::table tables = to_table(dict, arrays);
        const auto at = [&](std::optional<double> t) {
          return job_of_tables(tables, arrays, outside_of(allow_outside), t);
        };
        Job opened = at(seconds_of(time));
        const double seconds = shutter_of(shutter, opened).seconds_at(opened.animate.fps);
        return open_shutter(std::move(opened), seconds, at);
      },
      nb::arg("tables"), nb::arg("allow_outside"), nb::arg("time").none(), nb::arg("shutter").none());
  job.def(
      "open_shutter",
      [](const Job& j, double seconds, const nb::callable& at) {
        Job opened = j;
        if (!last_change(opened)) opened.last_key = opened.time + seconds;  // a function moves what it likes
        return open_shutter(std::move(opened), seconds, [&](double time) { return nb::cast<Job>(at(time)); });
      },
      nb::arg("seconds"), nb::arg("at"));
  job.def_ro("time", &Job::time);
  job.def_prop_ro("last_key", [](const Job& j) { return last_change(j); });
  job.def(
      "times",
      [](const Job& j, const nb::dict& given, nb::handle shutter) {
        AnimateParams params = j.animate;
        set_params(given, params);
        const double open = shutter_of(shutter, j).seconds_at(params.fps);
        return std::tuple(times_of(params, last_change(j)), params.from_last,
                          params.times.empty() ? std::min(open, 1 / params.fps) : open);
      },
      nb::arg("params"), nb::arg("shutter").none());
  job.def("move_eye", [](Job& j, nb::handle time) {
    j.time = to_time(time, "time");
    follow_eye_track(j);
  });
  job.def("set", [](Job& j, const std::string& stage, const nb::dict& given) {
    with_stage(j, stage, [&](auto& params) { set_params(given, params); });
    j.are_distances_given = j.are_distances_given || (stage == "camera" && given.contains("distances"));
    follow_eye_track(j);
  });
  job.def("get", [](Job& j, const std::string& stage) {
    nb::list list;
    with_stage(j, stage, [&](auto& params) { list = list_params(params); });
    return list;
  });
  job.def_prop_rw(
      "wavelengths", [](const Job& j) { return j.wavelengths; },
      [](Job& j, nb::handle wavelengths) { set_wavelengths(to_wavelengths(wavelengths), j); });
  job.def_rw("slm", &Job::slm);
  job.def_ro("warnings", &Job::warnings);
  job.def_prop_ro("counts", [](const Job& j) {
    size_t triangles = 0;
    for (const Mesh& mesh : j.scene.meshes) triangles += mesh.triangles.size();
    return nb::make_tuple(j.scene.meshes.size(), triangles, j.scene.points.size(), j.scene.lights.size());
  });

  job.def_prop_ro("meshes", [](nb::handle self) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    nb::list meshes;
    for (const Mesh& mesh : nb::cast<const Job&>(self).scene.meshes)
      meshes.append(nb::make_tuple(
          mesh.name, view(self, reinterpret_cast<const double*>(mesh.positions.data()), {mesh.positions.size(), 3}),
          view(self, mesh.triangles.data()->data(), {mesh.triangles.size(), 3})));
    return meshes;
  });

  module.def("is_model", [](const std::string& path) { return is_model(path); });
  module.def("slm_of_table", [](const nb::dict& dict) {
    SceneArrays none;
    return slm_of_table(to_table(dict, none));
  });
  module.def("render", &render_scene);
  module.def("render_pair", &render_pair);
  module.def(
      "focal_stack",
      [](const Job& job, nb::handle distances, const nb::dict& given, Watch& watch) {
        return trace_stack(job, to_lengths(distances, "distances"), given, watch);
      },
      nb::arg("scene"), nb::arg("distances").none(), nb::arg("params"), nb::arg("watch"));
  module.def("trace", &trace_sources);
  module.def("fields", &fields_of_scene);
}

}  // namespace holotrace::python
