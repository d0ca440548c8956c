#pragma once

#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/params/model.h"
#include "holotrace/data/scene.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

/// The turn about y [rad] after which a model shows most: for files whose format does not say where the front is. What it
/// shows is the sum of the differences of the normals of neighbouring
/// pixels, each at most 1, over a picture in parallel projection, with 1 for each pixel of its outline. What is
/// nearer counts more, so that a head looks at the viewer.
/// @param turns  to choose from; the first one is taken unless another shows 1 % more
/// @param view   from the turned model's frame to that of the picture, which is seen along −z
double turn_that_shows_most(const std::vector<Mesh>& meshes, const std::vector<double>& turns, const Frame& view);

/// The job that load_job makes of a file of meshes or points alone: a model on a floor in the light of a photographer.
///
/// **Place.** The model stands 19.5 panel widths behind the panel (300 mm for `pluto`), where the panel resolves about
/// as much as it has pixels. It is upright, turned (`rotation`), and seen from 18° above. Without a rotation it is turned
/// by 30° from its front: +z in glTF, else one of eight turns, the one that shows most. Its bounds, with the part of
/// the floor around it, take `fit` of the view's width or height.
///
/// **Floor.** A round, diffuse, grey floor under its lowest point. Its albedo falls to 0 at 1.6 times the radius of the
/// model, so that it has no edge.
///
/// **Light.** Two square lamps that face the model: a key light above left in front of it, and a weaker, larger fill light
/// on the right. Even light comes from all around. White that faces the key light has a radiance of about 1. If the file
/// has lights, they take the place of the lamps, and the even light is as strong beside them.
///
/// **Camera.** With `model_camera` the panel stands before the model in the direction of that camera, and the height of its
/// picture, where half of what it sees is nearer, is that of the panel. It has no floor. What
/// is nearer and outside of its picture is cut away. An animated camera moves the model before the panel.
///
/// The camera is focused on the nearest and on the farthest surface that faces the panel. Colours are chosen
/// (choose_wavelengths). All else is as in an empty scene file.
/// @param slm     panel that shows it
/// @param time    time of the model's first animation [s]. Place, size and light are those for the model at 0 s.
/// @throws Error  as load_meshes does, for a rotation that cannot be read, a camera that the file does not have or that sees
///                nothing, and for lights of the file if it has none
Job job_for_model(const std::string& path, const Slm& slm, const ModelParams& params = {},
                  Outside outside = Outside::refused, double time = 0);

/// Whether a file, a series of files or a film makes a job by itself, without a scene: a model (is_mesh_file), or pictures that follow
/// each other (is_picture_series).
bool is_model(const std::string& path);

/// The job that load_job makes of a series of pictures or a film: the picture of that time (load_picture) stands before the panel, with
/// the view in its middle, and the camera is focused on it. It takes `fit` of the view's width or height, at `model_distance`.
/// There are three colours if the first picture has three channels.
/// @throws Error  as load_picture does
Job job_for_pictures(const std::string& path, const Slm& slm, const ModelParams& params = {}, double time = 0);

}  // namespace holotrace
