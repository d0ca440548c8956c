// The verb view: what a camera sees of holograms, and its files.

#include "holotrace/io/run/save_run.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/view/stereo.h"
#include "params.h"
#include "results.h"
#include "watch.h"

namespace holotrace::python {
namespace {

std::vector<Viewpoint> viewpoints_of(const ViewRecord& record) {
  RenderParams eyes;
  eyes.eye = record.camera.eye;
  eyes.eye_separation = record.eye_separation;
  return viewpoints(record.camera, eyes);
}

nb::dict view_holograms(const std::vector<const Hologram*>& holograms, const std::vector<const Slm*>& panels,
                        const nb::dict& stages, nb::handle eye_separation, Watch& watch) {
  ViewRecord record;
  if (!holograms.empty()) record.camera = camera_in(holograms.front()->viewing);
  ViewingParams params;
  set_params(nb::cast<nb::dict>(stages["show"]), params.show);
  set_params(nb::cast<nb::dict>(stages["propagate"]), params.propagation);
  set_params(nb::cast<nb::dict>(stages["camera"]), record.camera);
  record.eye_separation = to_length(eye_separation, "eye_separation");
  check_named(record.eye_separation, range::not_negative, Quantity::length, "eye_separation");
  params.camera = record.camera;
  params.from = viewpoints_of(record);
  const HologramSeries series{holograms.size(), [&](size_t i) { return PanelHologram{*holograms[i], *panels[i]}; }};
  SeriesViews seen = watch.run("show", [&](const Observer&) {
    return view_holograms(series, params, record.report,
                          [&](const std::string& stage) { return watch.observer(stage); });
  });
  nb::dict results;
  results["views"] = moved(seen.views.images);
  results["white"] = seen.views.white;
  results["sweep"] = moved(seen.sweep.images);
  results["sweep_white"] = seen.sweep.white;
  results["stereo"] = moved(seen.stereo.images);
  results["stereo_white"] = seen.stereo.white;
  results["report"] = json_of(record.report);
  results["record"] = nb::cast(std::move(record));
  return results;
}

void save(const std::string& path, const SeriesViews& views, const ViewRecord& record, Watch& watch) {
  watch.run("save", [&](const Observer& observer) {
    check_views_output(path, record.camera);
    const std::vector<Viewpoint> from = viewpoints_of(record);
    for (const std::string& note :
         write_views(path, {from, views.views, views.sweep, views.stereo, record.camera}, observer))
      observer.warn(note);
    return true;
  });
}

}  // namespace

void bind_view_verbs(nb::module_& module) {
  nb::class_<ViewRecord> record(module, "ViewRecord");
  bind_bytes<ViewRecord>(record);
  module.def("view", &view_holograms, nb::arg("holograms"), nb::arg("panels"), nb::arg("stages"),
             nb::arg("eye_separation").none(), nb::arg("watch"));
  module.def("save_views", [](const std::string& path, const nb::dict& made, const ViewRecord& record, Watch& watch) {
    save(path,
         {series_of(made, "views", "white"), series_of(made, "sweep", "sweep_white"),
          series_of(made, "stereo", "stereo_white")},
         record, watch);
  });
  module.def("anaglyph", &anaglyph);
}

}  // namespace holotrace::python
