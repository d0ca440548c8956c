#pragma once

#include <string>

#include "holotrace/data/job.h"
#include "holotrace/data/params/model.h"
#include "holotrace/io/files/outside.h"

namespace holotrace {

/// The job that load_job makes of a file of meshes or points alone: a model on a floor in the light of a photographer.
///
/// **Place.** The model stands 19.5 panel widths behind the panel (300 mm for `pluto`), where the panel resolves about
/// as much as it has pixels. It is upright, turned (`rotation`), and seen from 18° above. Without a rotation it is turned
/// by 30° from its front: +z in glTF, else one of eight turns, the one that shows most (model_front.h). Its bounds, with the part of
/// the floor around it, take `fit` of the view's width or height.
///
/// **Floor.** A round, diffuse, grey floor under its lowest point. Its albedo falls to 0 at 1.6 times the radius of the
/// model, so that it has no edge.
///
/// **Light.** Two square lamps that face the model: a key light above left in front of it, and a weaker, larger fill light
/// on the right. Even light comes from all around. White that faces the key light has a radiance of about 1.
///
/// The camera is focused on the nearest and on the farthest surface that faces the panel. Colours are chosen
/// (choose_wavelengths). All else is as in an empty scene file.
/// @param slm     panel that shows it
/// @throws Error  as load_meshes does, and for a rotation that cannot be read
Job job_for_model(const std::string& path, const Slm& slm, const ModelParams& params = {},
                  Outside outside = Outside::refused);

}  // namespace holotrace
