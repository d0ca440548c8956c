// Linear propagation and the panel with their analytic adjoints, for automatic differentiation.

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "arrays.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "nouns.h"
#include "params.h"

namespace holotrace::python {
namespace {

// An array that owns its memory.
template <class T>
nb::object owned(Array2D<T>&& array) {
  auto* kept = new Array2D<T>(std::move(array));
  const nb::capsule owner(kept, [](void* memory) noexcept { delete static_cast<Array2D<T>*>(memory); });
  return view(owner, *kept);
}

void require_processor(const DeviceChoice& device, const char* instead) {
  require(device.kind == DeviceKind::cpu, "expected the device cpu for gradients, got {}; leave out device, or use {}",
          device_text(device), instead);
}

/// Free space over one distance as a linear operator T on arrays of samples, with its adjoint.
template <class Real>
class Propagation {
 public:
  using Complex = std::complex<Real>;

  Propagation(int rows, int columns, nb::handle pitch, nb::handle wavelength, nb::handle distance,
              const nb::dict& given) {
    Grid grid{columns, rows, to_length(pitch, "pitch")};
    const double colour = to_wavelength(wavelength), metres = to_length(distance, "distance");
    PropagateParams params;
    set_params(given, params);
    require_processor(params.device, "ht.propagate");
    const nb::gil_scoped_release release;
    forward_ = cached_propagator<Real>(grid, colour, metres, params);
    require(forward_->is_on_lattice(),
            "expected an output of the input's pitch for gradients, got another; leave out pitch, or use ht.propagate");
  }

  nb::object apply(const In2<Complex>& samples) const { return run(samples, forward_->input, false); }
  nb::object adjoint(const In2<Complex>& samples) const { return run(samples, forward_->output, true); }
  nb::tuple output_shape() const { return nb::make_tuple(forward_->output.ny, forward_->output.nx); }

 private:
  nb::object run(const In2<Complex>& samples, const Grid& grid, bool is_adjoint) const {
    require(int(samples.shape(0)) == grid.ny && int(samples.shape(1)) == grid.nx,
            "expected samples of the shape ({}, {}), got ({}, {})", grid.ny, grid.nx, samples.shape(0),
            samples.shape(1));
    BasicField<Real> result;
    {
      const nb::gil_scoped_release release;
      BasicField<Real> field;
      field.grid = grid;
      field.wavelength = forward_->wavelength;
      field.samples.ny = grid.ny;
      field.samples.nx = grid.nx;
      field.samples.values.assign(samples.data(), samples.data() + samples.size());
      result = is_adjoint ? back(field) : propagate(field, *forward_);
    }
    return owned(std::move(result.samples));
  }

  BasicField<Real> back(const BasicField<Real>& field) const {
    std::call_once(has_backward_, [this] { backward_ = adjoint_of(*forward_); });
    return propagate(field, *backward_);
  }

  std::shared_ptr<const Propagator<Real>> forward_;
  mutable std::once_flag has_backward_;
  mutable std::optional<Propagator<Real>> backward_;
};

template <class Real>
void bind_propagation(nb::module_& module, const char* name) {
  using P = Propagation<Real>;
  nb::class_<P>(module, name)
      .def(nb::init<int, int, nb::handle, nb::handle, nb::handle, const nb::dict&>(), nb::arg("rows"),
           nb::arg("columns"), nb::arg("pitch").none(), nb::arg("wavelength").none(), nb::arg("distance").none(),
           nb::arg("params"))
      .def("apply", &P::apply)
      .def("adjoint", &P::adjoint)
      .def_prop_ro("output_shape", &P::output_shape);
}

/// A panel under coherent light: levels to the light that leaves it, and gradients back.
class Panel {
 public:
  Panel(const Slm& slm, nb::handle wavelength, const nb::dict& given)
      : grid_(slm.grid), levels_(slm.levels), is_phase_(slm.modulation == Modulation::phase) {
    ShowParams params;
    set_params(given, params);
    require_processor(params.device, "ht.show");
    require(slm.modulation != Modulation::complex, "expected a panel of phase or amplitude for gradients, got complex");
    const double colour = params.wavelength > 0 ? params.wavelength : to_wavelength(wavelength);
    const double design = slm.design_wavelength > 0 ? slm.design_wavelength : to_wavelength(wavelength);
    model_.emplace(with_effects_or_own(slm, params.effects), params, slm.modulation, slm.levels, design,
                   IlluminationState{colour, params.tilt_x, params.tilt_y});
  }

  nb::object leave(const In2<float>& drive) const {
    const Array2D<float> levels = checked(drive);
    Field field;
    {
      const nb::gil_scoped_release release;
      field = model_->leave(levels);
    }
    return owned(std::move(field.samples));
  }

  nb::object pull_back(const In2<float>& drive, const In2<std::complex<float>>& gradient) const {
    const Array2D<float> levels = checked(drive);
    Array2D<std::complex<float>> light = to_array(gradient, "a gradient");
    Array2D<float> slopes(levels.ny, levels.nx);
    {
      const nb::gil_scoped_release release;
      model_->add_slopes({levels}, light, 1, {slopes});
    }
    return owned(std::move(slopes));
  }

  int levels() const { return levels_; }
  double pitch() const { return grid_.pitch; }

 private:
  Array2D<float> checked(const In2<float>& drive) const {
    Array2D<float> levels = to_array(drive, "the levels of a panel");
    const int most = is_phase_ ? levels_ : levels_ - 1;  // phases come round; an amplitude above the last is no panel's
    for (const float level : levels.values)
      require(level >= 0 && level <= float(most), "expected levels from 0 to {}, got {}; {}", most, level,
              is_phase_ ? fmt::format("take them modulo {}", levels_) : "limit them to that range");
    return levels;
  }

  Grid grid_;
  int levels_;
  bool is_phase_;
  std::optional<PanelModel> model_;
};

}  // namespace

void bind_gradients(nb::module_& module) {
  bind_propagation<float>(module, "Propagation32");
  bind_propagation<double>(module, "Propagation64");
  nb::class_<Panel>(module, "Panel")
      .def(nb::init<const Slm&, nb::handle, const nb::dict&>(), nb::arg("slm"), nb::arg("wavelength").none(),
           nb::arg("params"))
      .def("leave", &Panel::leave)
      .def("pull_back", &Panel::pull_back)
      .def_prop_ro("levels", &Panel::levels)
      .def_prop_ro("pitch", &Panel::pitch);
}

}  // namespace holotrace::python
