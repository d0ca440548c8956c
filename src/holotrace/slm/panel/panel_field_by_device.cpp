#include "holotrace/slm/panel/panel_field_by_device.h"

#include <algorithm>
#include <complex>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/panel_parts.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

// For the memory that there is once all that is kept there for later is dropped.
PanelBands plan_on(const Device& device, const PanelModel& panel) {
  return BandedPanel::plan(panel, possible_room(device), device.info().largest_buffer);
}

double field_bytes(const PanelModel& panel) { return double(panel.head().grid.pixels()) * sizeof(std::complex<float>); }

// The field, fetched column band by column band.
Field field_here(Device& device, const PanelModel& panel, const PanelPattern& pattern) {
  Field field = panel.head();
  field.samples = Array2D<std::complex<float>>(field.grid.ny, field.grid.nx);
  std::vector<std::complex<float>> part;
  BandedPanel(device, panel)
      .leave({pattern.drive, pattern.modulus}, [&](const SampleColumns& columns, DeviceBuffer& u) {
        if (columns.count == field.grid.nx) return device.read(u, field.samples.values.data(), u.bytes());
        part.resize(u.bytes() / sizeof part[0]);
        device.read(u, part.data(), u.bytes());
        for (int j = 0; j < field.grid.ny; ++j)
          std::copy_n(part.data() + size_t(j) * size_t(columns.count), columns.count,
                      field.samples.row(j) + columns.first);
      });
  return field;
}

// The field on the device.
DeviceField field_there(Device& device, const PanelModel& panel, const PanelPattern& pattern) {
  BandedPanel there(device, panel);
  DeviceField field{&device, panel.head(), {}};
  const bool is_whole = plan_on(device, panel).is_whole();
  if (!is_whole) field = make_device_field(device, panel.head(), "the light of a panel");
  there.leave({pattern.drive, pattern.modulus}, [&](const SampleColumns& columns, DeviceBuffer& u) {
    if (is_whole)
      field.samples = std::move(u);
    else
      put(u, {columns.first, columns.first + columns.count, 0, field.head.grid.ny}, field);
  });
  return field;
}

// Whether the field can stay: all of it is computed at once, or it takes half of the free memory at most, and bands of it are
// computed in the rest.
bool can_stay(const Device& device, const PanelModel& panel) {
  return plan_on(device, panel).is_whole() || 2 * field_bytes(panel) <= possible_room(device);
}

// What leave(device) returns on the device of a choice, under its lock. @param returns  whether it fetches the field
template <class Leave>
auto compute_where_chosen(const PanelModel& panel, const PanelPattern& pattern, const DeviceChoice& choice,
                          bool returns, const Observer& observer, const Leave& leave) {
  if (choice.kind != DeviceKind::cpu) panel.check_pattern(pattern.drive, pattern.modulus);
  const auto fastest = [&] {
    const PanelWork work = panel.work();
    const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
    return fastest_device(predict_seconds(work.on_processor, summation_rates(), threads), [&](Device& there) {
      const DeviceRates rates = device_rates(there);
      const PanelBands bands = plan_on(there, panel);
      if (bands.rows == 0) return std::numeric_limits<double>::infinity();
      // Levels are sent, and rows transformed, once for each band of columns.
      const bool is_fetched = returns || !can_stay(there, panel);
      const double transfers = bands.column_bands * work.sent + (is_fetched ? work.fetched : 0);
      return bands.column_bands * work.moved / rates.moved_bytes + transfers / rates.bytes + seconds_to_start;
    });
  };
  return on_chosen_device(choice, observer, fastest, [&](Device& device) {
    const auto lock = device.lock();
    const PanelBands bands = BandedPanel::plan(panel, device.memory_left(), device.info().largest_buffer);
    if (!bands.is_whole()) make_room(device, std::numeric_limits<double>::infinity());
    return leave(device);
  });
}

}  // namespace

std::optional<Field> panel_field_by_device(const PanelModel& panel, const PanelPattern& pattern,
                                           const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, true, observer,
                              [&](Device& device) { return field_here(device, panel, pattern); });
}

std::optional<PanelField> panel_field_on_device(const PanelModel& panel, const PanelPattern& pattern,
                                                const DeviceChoice& choice, const Observer& observer) {
  return compute_where_chosen(panel, pattern, choice, false, observer, [&](Device& device) {
    const auto with_power = [](auto field) {
      const double here = power(field);
      return PanelField{std::move(field), here};
    };
    return can_stay(device, panel) ? with_power(field_there(device, panel, pattern))
                                   : with_power(field_here(device, panel, pattern));
  });
}

namespace {

constexpr double float_bytes = sizeof(float), complex_bytes = sizeof(std::complex<float>);
constexpr double usable = 0.9;  // of the memory: long lines need work space

int bands_of(int count, int at_once) { return (count + at_once - 1) / at_once; }

// Rows of an array and the ones beside them; after the last row comes the first.
std::vector<float> rows_of(const Array2D<float>& values, const PixelRows& rows) {
  std::vector<float> part;
  part.reserve(size_t(rows.count + 2 * rows.halo) * size_t(values.nx));
  for (int j = rows.first - rows.halo; j < rows.first + rows.count + rows.halo; ++j) {
    const float* row = values.row((j % values.ny + values.ny) % values.ny);
    part.insert(part.end(), row, row + values.nx);
  }
  return part;
}

}  // namespace

PanelBands BandedPanel::plan(const PanelModel& model, double memory, double largest) {
  const PanelModel::Parts& p = *model.parts_;
  const int nx = p.nx(), ny = p.ny(), width = p.out.nx, height = p.out.ny;
  const double n = p.params.subpixels, terms = p.expansion.terms, pairs = p.expansion.pairs();
  const bool is_complex = p.modulation == Modulation::complex;
  const double values = p.response.has_amplitude() || is_complex ? 2 : 1;
  const double reach = p.has_crosstalk ? p.blur.along_y().reach : 0;
  // Of each pixel: levels, what they show, what the maps hold; the blur, the terms, and one of them.
  const double of_halo = float_bytes * ((is_complex ? 2 : 1) + values) + DevicePanel::bytes_of_pixel_maps(model);
  const double of_pixel = (p.has_crosstalk ? float_bytes * values : 0) + complex_bytes * (pairs + n);
  const auto rows_bytes = [&](double rows) {
    return nx * ((rows + (rows < ny ? 2 * reach : 0)) * of_halo + rows * of_pixel);
  };
  // Of each column: terms along it, apart if there are several samples, turned and as they leave, and what the maps hold.
  const auto column_bytes = [&](double rows) {
    return complex_bytes * (rows + ny * (rows < ny ? terms : 1) + height * (n > 1 ? 3 : 2)) +
           height * DevicePanel::bytes_of_sample_maps(model);
  };
  const double space = usable * memory, of_rows = complex_bytes * nx * std::max(pairs, n);
  const auto columns_beside = [&](int rows) {
    const double columns =
        std::min((space - rows_bytes(rows)) / column_bytes(rows), largest / (complex_bytes * std::max(height, rows)));
    return int(std::clamp(columns, 0.0, double(width)));
  };
  PanelBands bands{ny, columns_beside(ny), 1, 1};
  if (bands.columns == width && of_rows * ny <= largest) return bands;
  // A quarter of the memory for the rows: their transforms are done again for each band of columns.
  double rows = std::min(largest / of_rows, double(ny));
  const double of_row = rows_bytes(2) - rows_bytes(1), beside = rows_bytes(1) - of_row;
  rows = std::min(rows, (space / 4 - beside) / of_row);
  bands.rows = int(std::max(1.0, rows));
  bands.columns = columns_beside(bands.rows);
  if (bands.columns == 0) return {};
  return {bands.rows, bands.columns, bands_of(ny, bands.rows), bands_of(width, bands.columns)};
}

BandedPanel::BandedPanel(Device& device, const PanelModel& model)
    : device_(device), model_(model), panel_(device, model, PanelMaps::in_bands) {}

// What all bands use: the arrays of a band, and of each term along the columns those of all rows.
struct BandedPanel::Memory {
  DevicePanel::Memory arrays;
  std::vector<DeviceBuffer> columns;
};

// A pattern, and how many bands of rows it has.
struct BandedPanel::Job {
  const PanelModel::Pattern& pattern;
  int halo;
};

BandedPanel::Memory BandedPanel::make_memory(const PanelBands& bands) {
  const DevicePanel::Sizes& sizes = panel_.sizes();
  const size_t rows = size_t(bands.rows), halo = bands.row_bands > 1 ? size_t(sizes.halo) : 0, nx = size_t(sizes.nx),
               columns = size_t(bands.columns), ny = size_t(sizes.ny), n = size_t(sizes.n);
  const auto make = [&](size_t floats) { return device_.make_buffer(floats * sizeof(float), "a panel"); };
  Memory memory;
  DevicePanel::Memory& a = memory.arrays;
  const auto make_pixels = [&](DevicePanel::Memory::Pixels& values, size_t count) {
    values.cycles = make(count);
    if (sizes.has_amplitude) values.amplitudes = make(count);
  };
  make_pixels(a.pixels, (rows + 2 * halo) * nx);
  if (sizes.halo > 0) make_pixels(a.blurred, rows * nx);
  a.terms = make(2 * size_t(sizes.expansion.pairs()) * rows * nx);
  a.term = make(2 * n * rows * nx);
  a.rows = make(2 * rows * columns);
  a.turned = make(2 * n * ny * columns);
  if (n > 1) a.spread = make(2 * n * ny * columns);
  for (int q = 0; q < (bands.row_bands > 1 ? sizes.expansion.terms : 1); ++q)
    memory.columns.push_back(make(2 * ny * columns));
  return memory;
}

// With the last rows, the terms are complete and go on along the columns.
void BandedPanel::leave_rows(const Job& job, const PixelRows& rows, const SampleColumns& columns,
                             const Memory& memory) {
  const DeviceBuffer drive = device_.upload(rows_of(job.pattern.drive, rows), "a panel");
  DeviceBuffer modulus;
  if (job.pattern.modulus) modulus = device_.upload(rows_of(*job.pattern.modulus, rows), "a panel");
  const PixelMaps maps = DevicePanel::pixel_maps(device_, model_, rows);
  panel_.make_terms({drive, job.pattern.modulus ? &modulus : nullptr}, rows, maps, memory.arrays);
  const bool is_last = rows.first + rows.count == panel_.sizes().ny;
  for (int q = 0; q < panel_.sizes().expansion.terms; ++q) {
    const DeviceBuffer& along = memory.columns[std::min(size_t(q), memory.columns.size() - 1)];
    panel_.spread_rows(q, rows, columns, memory.arrays, along);
    if (is_last) panel_.spread_columns(q, columns, along, memory.arrays);
  }
  device_.finish();  // before the rows are released
}

void BandedPanel::leave(const PanelModel::Pattern& pattern,
                        const std::function<void(const SampleColumns& columns, DeviceBuffer& u)>& take) {
  const auto lock = device_.lock();
  const DevicePanel::Sizes& sizes = panel_.sizes();
  const int width = sizes.n * sizes.nx, height = sizes.n * sizes.ny;
  const double left = device_.memory_left();
  const PanelBands bands = plan(model_, left, device_.info().largest_buffer);
  require(
      bands.rows > 0,
      "expected memory for a row and a column of a panel of {} × {} pixels on the device {}, got {} that are free; close "
      "other programs that use it, or use the device cpu",
      sizes.nx, sizes.ny, device_.info().name, format_bytes(std::max(0.0, left)));
  const Memory memory = make_memory(bands);
  const Job job{pattern, bands.row_bands > 1 ? sizes.halo : 0};
  for (int first = 0; first < width; first += bands.columns) {
    const SampleColumns columns{first, std::min(bands.columns, width - first)};
    for (int row = 0; row < sizes.ny; row += bands.rows)
      leave_rows(job, {row, std::min(bands.rows, sizes.ny - row), job.halo}, columns, memory);
    const SampleMaps maps = DevicePanel::sample_maps(device_, model_, columns);
    DeviceBuffer u = device_.make_buffer(size_t(height) * size_t(columns.count) * sizeof(std::complex<float>),
                                         "the light of a panel");
    panel_.finish(columns, maps, memory.arrays, u);
    take(columns, u);
    device_.finish();  // before the maps are released
  }
}

}  // namespace holotrace
