#pragma once

#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The channel of a picture whose values are a hologram's.
enum class Channel { grey, red, green, blue };
inline constexpr std::initializer_list<Choice<Channel>> channel_names{
    {"grey", Channel::grey}, {"red", Channel::red}, {"green", Channel::green}, {"blue", Channel::blue}};

/// What holograms of other programs do not say of themselves. Holograms of this one keep it as metadata.
struct HologramParams {
  ImageSide image = ImageSide::virtual_image;  ///< side of the panel on which it shows its picture
  Modulation modulation = Modulation::phase;   ///< what its greys mean
  int levels = 0;                              ///< number of levels; 0: all greys of its bits
  double pitch = 0;                            ///< pixel pitch [m]; 0: the panel's
  double range = 0;                            ///< phase range (Slm::phase_range) [rad]; 0: the panel's own
  double wavelength = 0;                       ///< that it was made for [m]; 0: not known
  Channel channel = Channel::grey;             ///< grey: all channels are equal
};

template <class Visitor>
void describe(Visitor&& v, HologramParams& p) {
  v(choice(
      "image", p.image, image_side_names,
      "side of the panel on which the image is: behind it (virtual) or in front of it (real); positive distances are "
      "on that side"));
  v(choice("modulation", p.modulation, {{"phase", Modulation::phase}, {"amplitude", Modulation::amplitude}},
           "meaning of the greys of a file without metadata"));
  v(count("levels", p.levels, range::or_value(0, range::from_to(2, 65536)),
          "number of levels of a file without metadata; 0: all greys of its bits"));
  v(length("pitch", p.pitch, range::not_negative, "pixel pitch; 0 m: the hologram's, or the panel's"));
  v(angle("range", p.range, range::not_negative,
          "phase range of the panel: phase that all levels together span, 360 deg for a full cycle; 0 deg: the panel's "
          "own value"));
  v(wavelength("wavelength", p.wavelength, range::not_negative,
               "wavelength of a file without metadata; 0 m: not known"));
  v(choice("channel", p.channel, channel_names, "channel with the hologram in a coloured picture without metadata"));
}

}  // namespace holotrace
