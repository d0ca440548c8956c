#include "holotrace/wave/propagate/convolve.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/wave/propagate/convolution.h"

namespace holotrace {

double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double columns = double(x.frequencies()) / x.parts + block;
  return 2.0 * double(bytes_per_real) * (columns * std::max(y.inputs, y.outputs) + double(x.outputs) * y.outputs);
}

namespace {

template <class Real>
void check_links(const std::vector<ConvolutionLink<Real>>& links) {
  const Propagator<Real>& first = *links.front().propagator;
  for (const ConvolutionLink<Real>& link : links) {
    const Propagator<Real>& p = *link.propagator;
    require(p.is_on_lattice(), "expected propagations between windows of one pitch, got two pitches");
    require(p.input == first.input && p.output == first.output && p.padded_nx == first.padded_nx &&
                p.padded_ny == first.padded_ny && p.x.first == first.x.first && p.x.last == first.x.last,
            "expected propagations with the same windows and the same band");
    require(!link.is_adjoint || p.input == p.output, "expected equal windows for an adjoint propagation");
  }
}

// Does the work of all links. Returns the part of the light that the band limit drops, if it is limited.
template <class Real>
std::optional<double> run_links(const std::vector<const BasicField<Real>*>& fields,
                                const std::vector<ConvolutionLink<Real>>& links, std::vector<BasicField<Real>>& outputs,
                                const Observer& observer) {
  const Propagator<Real>& p = *links.front().propagator;
  Convolution<Real> convolution(fields, links, outputs);
  const int most = (p.x.frequencies() + p.x.parts - 1) / p.x.parts;
  std::vector<ColumnBlocks<Real>> blocks;
  for (size_t i = 0; i < links.size(); ++i) blocks.emplace_back(most, std::max(p.y.inputs, p.y.outputs));
  for (int part = 0; part < p.x.parts; ++part) convolution.run(part, blocks, observer);
  return convolution.is_band_limited() ? std::optional(convolution.dropped_part()) : std::nullopt;
}

template <class Real>
BasicField<Real> output_of(const ConvolutionLink<Real>& link, double wavelength, double z) {
  const Propagator<Real>& p = *link.propagator;
  BasicField<Real> out(p.output, wavelength, z + (link.is_adjoint ? -p.distance : p.distance));
  out.grid.centre_x += link.shift_x * out.grid.pitch;
  out.grid.centre_y -= link.shift_y * out.grid.pitch;
  return out;
}

}  // namespace

template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer) {
  std::vector<BasicField<Real>> out;
  out.push_back(output_of(ConvolutionLink<Real>{&p}, field.wavelength, field.z));
  const auto dropped = run_links<Real>({&field}, {{&p}}, out, observer);
  if (dropped) observer.fact("energy_beyond_band", *dropped);
  return std::move(out.front());
}

template <class Real>
std::vector<BasicField<Real>> convolve_to_many(const BasicField<Real>& field,
                                               const std::vector<ConvolutionLink<Real>>& links) {
  check_links(links);
  std::vector<BasicField<Real>> out;
  for (const ConvolutionLink<Real>& link : links) out.push_back(output_of(link, field.wavelength, field.z));
  run_links<Real>({&field}, links, out, {});
  return out;
}

template <class Real>
BasicField<Real> convolve_to_sum(const std::vector<const BasicField<Real>*>& fields,
                                 const std::vector<ConvolutionLink<Real>>& links) {
  check_links(links);
  require(fields.size() == links.size(), "expected a propagation for each of {} fields, got {}", fields.size(),
          links.size());
  std::vector<BasicField<Real>> out;
  out.push_back(BasicField<Real>(links.front().propagator->output, fields.front()->wavelength));
  run_links<Real>(fields, links, out, {});
  return std::move(out.front());
}

template Field convolve(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble convolve(const FieldDouble&, const Propagator<double>&, const Observer&);
template std::vector<Field> convolve_to_many(const Field&, const std::vector<ConvolutionLink<float>>&);
template Field convolve_to_sum(const std::vector<const Field*>&, const std::vector<ConvolutionLink<float>>&);

}  // namespace holotrace
