#pragma once

#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Fast takes half the time of high, and has 0.2 to 0.7 dB more error.
enum class DenoiseQuality { fast, high };

/// What the surfaces in a picture look like without light, on its pixels: a denoiser tells textures and edges from noise by them.
/// Both are empty where there are no guides. The program's own pictures have none, because more light paths in the time
/// that guides take gain as much (explanation/path_tracing.md).
struct DenoiseGuides {
  Image albedo;   ///< fraction of the light that the surface reflects, in red, green and blue
  Image normals;  ///< unit normal on the viewer's side, three channels
};

/// Whether a picture has three equal channels.
bool is_grey(const Image& image);

/// A path-traced picture without the noise of few light paths: what the network of Open Image Denoise 2 expects the
/// mean of many paths to be. Edges and textures stay where the picture or its guides show them.
///
/// The network darkens noisy pictures by about 1 %. Each pixel is therefore multiplied by the light of its neighbourhood before
/// over that after, the means of a tent of 33 × 33 pixels, limited to 0.8 to 1.25:
///
///     L = N·⟨radiance⟩/⟨N⟩,   N the network's picture
///
/// so that means over regions are those of the light paths. The picture remains an estimate with a bias at its details: do
/// not measure with it. explanation/path_tracing.md has its errors.
///
/// Grey pictures of three channels stay grey. Black borders stay as they are, and so do pictures with fewer than 16 columns or rows of light.
///
/// @param radiance  linear light, 1 or 3 channels, finite values of 0 or more
/// @param guides    both on the picture's pixels, or none. They are denoised first, and take 3.4 times the time of the picture
///                  more
/// @param observer  receives progress; if it throws, the exception reaches the caller
/// @return          a picture of the same size, pitch and place, with values of 0 or more; the same bytes on any number of
///                  threads
/// @throws Error    for other pictures and guides, and if memory does not suffice; NoDenoiser without the library
///
/// Cost: on one core 2.7 µs for each pixel of the part with light (fast: 1.5 µs), and up to 1.2 GB of memory (fast: 0.4
/// GB).
Image denoise(const Image& radiance, const DenoiseGuides& guides = {}, DenoiseQuality quality = DenoiseQuality::high,
              const Observer& observer = {});

/// Pictures cannot be denoised on this machine.
class NoDenoiser : public Error {
 public:
  NoDenoiser(const std::string& sentence, bool is_broken) : Error(sentence), is_broken(is_broken) {}
  bool is_broken;  ///< a library was found, or named by HOLOTRACE_OIDN, but cannot be used
};

/// Name and version of the library that denoises pictures: "Open Image Denoise 2.5.1".
/// @throws NoDenoiser  if there is none, or none of version 2.3 to 2.x
std::string find_denoiser();

/// Names a folder in which the library is looked for, before the system's.
void look_for_denoiser_in(const std::string& folder);

}  // namespace holotrace
