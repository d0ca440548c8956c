#pragma once

#include <string>
#include <vector>

#include "holotrace/data/eye_track.h"
#include "holotrace/data/job.h"

namespace holotrace {

/// Reads the places of an eye over time from a table of text:
///
///     # comments and empty lines are allowed
///     time_s,x_mm,y_mm,z_mm
///     0,-5,0,250
///     0.00833,-4.9,0,250
///
/// The first line names the columns: time, x, y and z, each with its unit (s, ms or us; m, cm, mm or um), in any order; other
/// columns are not read. Without such a line the columns are those above. Values are separated by commas, semicolons or tabs. x is right,
/// y up and z towards the viewer, from the centre of the panel.
/// @throws Error with the number of the line for missing columns, values that are no finite numbers, times out of order, and eyes
///         that are not in front of the panel; for less than two places
EyeTrack load_eye_track(const std::string& path);

/// Lets the eye of a job be that of its eye track (job.eye) at job.time; nothing without a track. The camera's eye is where the
/// eye is; holograms that aim at an eye aim at the measured one. A camera without a pupil gets that of the job's eyes, or
/// eye_pupil. The last time of the track counts as a key.
/// @throws Error  as load_eye_track and tracked_eye do; for a time after the track; for holograms of several eyes
void follow_eye_track(Job& job);

/// The places that holograms of a job with an eye track are made for, at some times [m]; none without a track.
std::vector<Vec3> measured_places(const Job& job, const std::vector<double>& times);

}  // namespace holotrace
