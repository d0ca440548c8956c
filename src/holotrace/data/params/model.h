#pragma once

#include <string>
#include <vector>

#include "holotrace/data/params/parameter.h"

// model: a file of a model → Job

namespace holotrace {

/// The axis of a model's own coordinates that points up.
enum class UpAxis { y, minus_y, z, minus_z, x, minus_x };

/// What a model stands on: a round floor whose light fades towards its edge, or nothing.
enum class ModelFloor { round, none };

/// The lamps of a model: those of its file if it has any, else a photographer's; always those of its file; or always a
/// photographer's.
enum class ModelLights { choose, file, studio };

/// How a model without a scene is shown.
struct ModelParams {
  UpAxis up = UpAxis::y;
  std::vector<std::string> rotation{};  ///< turns of the upright model on its floor, one after the other; none: chosen
  double fit = 0.8;                     ///< part of the view's width or height that the model takes
  ModelFloor floor = ModelFloor::round;
  double model_distance = 0;  ///< from the panel to the model's middle [m]; 0: 19.5 panel widths
  ModelLights model_lights = ModelLights::choose;
  std::string model_camera{};  ///< camera of the file whose view is shown, in place of up, rotation, fit and floor
  double series_fps = 25;      ///< files per second of a series of models or pictures
  double turntable = 0;        ///< time in which the model turns once about its upright axis [s]; 0: it rests
};

template <class Visitor>
void describe(Visitor&& v, ModelParams& p) {
  v(choice("up", p.up,
           {{"y", UpAxis::y},
            {"-y", UpAxis::minus_y},
            {"z", UpAxis::z},
            {"-z", UpAxis::minus_z},
            {"x", UpAxis::x},
            {"-x", UpAxis::minus_x}},
           "models: axis of the file that points up"));
  v(texts(
      "rotation", p.rotation,
      "models: turns of the upright model about its axes, one after the other, such as \"y 90 deg, x 10 deg\"; empty: "
      "y -30 deg if its format says that z is its front (glTF), else one of eight turns, the one that shows most"));
  v(number("fit", p.fit, range::fraction_above_0,
           "models: part of the view's width or height that the model or the pictures take"));
  v(choice("floor", p.floor, {{"round", ModelFloor::round}, {"none", ModelFloor::none}},
           "models: what the model stands on: a round floor that fades towards its edge, or nothing"));
  v(length(
      "model_distance", p.model_distance, range::not_negative,
      "models: distance from the panel to the middle of the model or to the pictures; 0 m: 19.5 panel widths, 300 mm for pluto"));
  v(choice("model_lights", p.model_lights,
           {{"auto", ModelLights::choose}, {"file", ModelLights::file}, {"studio", ModelLights::studio}},
           "models: lamps: those of its file (glTF), two of a photographer, or auto: those of the file if it has any"));
  v(text("model_camera", p.model_camera,
         "models: name of a camera of the file (glTF), or its number from 1, whose view is shown, without a floor; "
         "up, rotation and fit then do not count"));
  v(number("series_fps", p.series_fps, range::above_to(0, 1e5),
           "series of models or pictures (wave_####.ply, frame_####.png): files per second"));
  v(time("turntable", p.turntable, range::or_value(0, range::from_to(0.01, 1e6)),
         "models: time in which the model turns once about its upright axis, as on a turntable; 0 s: it rests"));
}

}  // namespace holotrace
