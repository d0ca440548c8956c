#include "banded_field.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "console.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_bands.h"
#include "holotrace/io/files/output.h"
#include "holotrace/opencl/device.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/wave/bands.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "holotrace/wave/synthesize.h"
#include "interrupts.h"

namespace holotrace {
namespace {

// Calls visit(name, rate). The processor and a device have rates of the same name.
template <class Rates, class Visit>
void for_each_rate(Rates& rates, const Visit& visit) {
  for (const SummationTerm& term : summation_terms) visit(std::string(term.name), rates.processor.*term.rate);
  for (const DeviceRateTerm& term : device_rate_terms)
    visit(std::string("device_") + term.name, rates.device.*term.rate);
}

}  // namespace

PlanRates plan_rates(const DeviceChoice& device) {
  PlanRates rates{summation_rates(), {}};
  if (device.kind == DeviceKind::opencl) rates.device = device_rates(open_device(device.number));
  if (device.kind == DeviceKind::all) rates.device = device_rates(open_device(0));
  return rates;
}

void go_by(const PlanRates& rates) {
  set_summation_rates([rates] { return rates.processor; });
  set_device_rates([rates](Device&) { return rates.device; });
}

std::map<std::string, double> named_rates(const PlanRates& rates) {
  std::map<std::string, double> named;
  for_each_rate(rates, [&](const std::string& name, double rate) { named[name] = rate; });
  return named;
}

PlanRates rates_of(const std::map<std::string, double>& named, PlanRates otherwise) {
  for_each_rate(otherwise, [&](const std::string& name, double& rate) {
    if (const auto found = named.find(name); found != named.end()) rate = found->second;
  });
  return otherwise;
}

namespace {

// One output file of the job: the sets of one name, and their bands in the order of the job.
struct BandFile {
  std::vector<size_t> sets, bands;
  std::unique_ptr<FieldBands> file;
};

struct Place {
  size_t file = 0, plane = 0, index = 0;  // index: index of the band within the file
};

// The work of rank 0, shared by its two threads.
struct Work {
  BandedField job;
  Observer observer;
  std::vector<Band> bands;
  std::vector<BandFile> files;
  std::vector<Place> places;  // places of the bands
  std::deque<size_t> waiting;
  std::mutex mutex;            // guards `waiting`, `done` and the journals
  std::vector<double> shares;  // fraction of the work in each band
  std::atomic<double> done{0};
  std::exception_ptr failure;
  std::atomic<bool> is_alone_done{false};

  void tell_progress(double begun = 0) { observer.progress(done + begun); }

  std::optional<size_t> take() {
    const std::lock_guard lock(mutex);
    if (waiting.empty()) return std::nullopt;
    const size_t band = waiting.front();
    waiting.pop_front();
    return band;
  }

  void write(size_t band, int first_row, int rows_to_write, const std::complex<float>* samples) {
    const Place& place = places[band];
    files[place.file].file->write_rows(place.plane, first_row, rows_to_write, samples);
  }

  void finish(size_t band) {
    const std::lock_guard lock(mutex);
    files[places[band].file].file->finish_band(places[band].index);
    done = done + shares[band];
    tell_progress();
  }

  void make_bands() {
    while (const std::optional<size_t> band = take()) {
      const Band& b = bands[*band];
      Observer o;
      o.on_progress = [&](double fraction) { tell_progress(fraction * shares[*band]); };
      const Field field = synthesize_band(job.sets[size_t(b.set)], job.panel, b, job.params, o);
      write(*band, b.first_row, b.rows(), field.samples.values.data());
      finish(*band);
    }
  }
};

void warn_of_missed_waves(const BandedField& job, const Observer& observer) {
  for (const Sources& set : job.sets)
    if (const int64_t missed = missed_waves(set, job.panel); missed > 0)
      observer.warn(
          fmt::format("{} of {} waves light no pixel: they are outside the panel's diffraction cone; move them nearer "
                      "to the axis or farther from the panel",
                      missed, set.waves.size()));
}

void check_sets(const BandedField& job) {
  check_band_method(job.params);
  require(job.params.tolerance > 0 && job.params.tolerance < 1, "expected a tolerance in (0, 1), got {}",
          job.params.tolerance);
  bool has_waves = false;
  for (const Sources& set : job.sets) {
    check_sources(set);
    has_waves = has_waves || !set.waves.empty();
  }
  require(has_waves, "expected at least one source, got none; is the scene lit and in view?");
}

// Sets of one name go into one file.
void sort_into_files(Work& work) {
  const std::vector<Sources>& sets = work.job.sets;
  for (size_t set = 0; set < sets.size(); ++set) {
    size_t file = 0;
    while (file < work.files.size() && sets[work.files[file].sets.front()].label.name != sets[set].label.name) ++file;
    if (file == work.files.size()) work.files.emplace_back();
    work.files[file].sets.push_back(set);
  }
  for (size_t band = 0; band < work.bands.size(); ++band)
    for (size_t file = 0; file < work.files.size(); ++file)
      for (size_t plane = 0; plane < work.files[file].sets.size(); ++plane)
        if (work.files[file].sets[plane] == size_t(work.bands[band].set)) {
          work.places.push_back({file, plane, work.files[file].bands.size()});
          work.files[file].bands.push_back(band);
        }
}

BandedJob describe_job(const Work& work, const BandFile& file) {
  const BandedField& job = work.job;
  std::vector<int> first_rows;
  for (const size_t band : file.bands) first_rows.push_back(work.bands[band].first_row);
  std::vector<const Sources*> sets;
  std::string waves;
  for (const size_t i : file.sets) {
    const Sources& set = job.sets[i];
    sets.push_back(&set);
    waves += fmt::format("{} waves at {}, ", set.waves.size(), format_length(set.wavelength));
  }
  return {fmt::format("{}x{} pixels of {}, {}method {}, tolerance {}, {} bands", job.panel.nx, job.panel.ny,
                      format_length(job.panel.pitch), waves, method_name(job.params.method), job.params.tolerance,
                      file.bands.size()),
          field_fingerprint(job.panel, job.params, sets, first_rows), file.bands.size(),
          named_rates(plan_rates(job.params.device))};
}

void open_files(Work& work) {
  for (size_t i = 0; i < work.files.size(); ++i) {
    BandFile& file = work.files[i];
    std::vector<Field> headers;
    for (const size_t set : file.sets) {
      Field header;
      header.grid = work.job.panel;
      header.wavelength = work.job.sets[set].wavelength;
      header.label = work.job.sets[set].label;
      headers.push_back(header);
    }
    const std::string path = numbered_path(work.job.output, i);
    file.file = std::make_unique<FieldBands>(path, headers, describe_job(work, file));
    const size_t there = file.file->finished_bands();
    if (there > 0) go_by(rates_of(file.file->settings(), plan_rates(work.job.params.device)));
    if (there > 0 && !work.job.is_quiet)
      say("holotrace: resuming {2}: {0} of {1} bands done\n", there, file.bands.size(), path);
  }
  for (size_t band = 0; band < work.bands.size(); ++band) {
    if (work.files[work.places[band].file].file->is_finished(work.places[band].index))
      work.done = work.done + work.shares[band];
    else
      work.waiting.push_back(band);
  }
}

void send_job(const Work& work, const Ranks& ranks) {
  const BandedField& job = work.job;
  const std::string head = to_message(JobHead{job.panel, job.params.method, job.params.tolerance, job.params.device,
                                              job.threads, int32_t(job.sets.size()), plan_rates(job.params.device)});
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, tag_job, head);
  for (const Sources& set : job.sets) {
    const std::string bytes = to_message(set);
    for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, tag_set, bytes);
  }
}

void hear(Work& work, const Ranks& ranks, const Ranks::Message& message, int& working) {
  if (message.tag == tag_failed) throw Error(message.bytes);
  if (message.tag == tag_rows) {
    RowsHead head;
    std::vector<std::complex<float>> samples;
    from_message(message.bytes, head, samples);
    work.write(head.band, head.first_row, head.rows, samples.data());
    return;
  }
  if (message.tag == tag_finished) {
    uint64_t band = 0;
    from_message(message.bytes, band);
    work.finish(band);
  }
  if (const std::optional<size_t> band = work.take()) {
    ranks.send(message.from, tag_band, to_message(BandOrder{*band, work.bands[*band]}));
  } else {
    --working;
  }
}

// This thread receives the messages, because MPI may be used by one thread only; another thread makes bands here. It
// shares ownership of the work: if this thread fails, it does not wait for the other one.
void share_bands(const std::shared_ptr<Work>& work, Ranks& ranks) {
  ranks.is_job_running = true;
  send_job(*work, ranks);
  std::thread([work] {
    try {
      work->make_bands();
    } catch (...) {
      work->failure = std::current_exception();
    }
    work->is_alone_done = true;
  }).detach();
  for (int working = ranks.size() - 1; working > 0 || !work->is_alone_done;) {
    if (work->is_alone_done && work->failure) std::rethrow_exception(work->failure);
    if (const std::optional<Ranks::Message> message = ranks.try_receive())
      hear(*work, ranks, *message, working);
    else
      std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  if (work->failure) std::rethrow_exception(work->failure);
  ranks.is_job_running = false;
}

}  // namespace

void make_field_in_bands(BandedField field, Ranks& ranks, const Observer& observer) {
  check_sets(field);
  const auto largest = std::max_element(field.sets.begin(), field.sets.end(), [](const Sources& a, const Sources& b) {
    return a.waves.size() < b.waves.size();
  });
  field.params.device = chosen_device(*largest, field.panel, field.params);  // one for all bands and ranks
  if (ranks.size() > 1 && field.params.device.kind == DeviceKind::all)
    field.params.device = {DeviceKind::opencl};  // ranks take one of all devices each
  const auto work = std::make_shared<Work>();
  work->bands = plan_bands(field.sets, field.panel, field.params, field.memory);
  work->job = std::move(field);
  work->observer = observer;
  work->shares = band_shares(work->job.sets, work->job.panel, work->bands);
  warn_of_missed_waves(work->job, observer);
  sort_into_files(*work);
  say_on_interrupt("holotrace: interrupted; the finished bands are kept, and the same command goes on from there\n");
  open_files(*work);
  work->tell_progress();
  if (ranks.size() > 1)
    share_bands(work, ranks);
  else
    work->make_bands();
  for (BandFile& file : work->files) file.file->finish();
}

// --- the ranks other than rank 0 ---

namespace {

// Sends the rows in pieces, so that the receiver needs little memory.
void send_rows(const Ranks& ranks, const BandOrder& order, const Field& field) {
  const int piece = std::max(1, int((4 << 20) / (sizeof(std::complex<float>) * size_t(field.grid.nx))));
  for (int row = 0; row < field.grid.ny; row += piece) {
    const int rows = std::min(piece, field.grid.ny - row);
    const std::complex<float>* from = field.samples.row(row);
    const std::vector<std::complex<float>> samples(from, from + size_t(rows) * size_t(field.grid.nx));
    ranks.send(0, tag_rows, to_message(RowsHead{order.index, order.band.first_row + row, rows}, samples));
  }
}

}  // namespace

void serve_bands(const Ranks& ranks, const Ranks::Message& job) {
  JobHead head;
  from_message(job.bytes, head);
  std::vector<Sources> sets(size_t(head.sets));
  for (Sources& set : sets) from_message(ranks.receive().bytes, set);
  const int threads = head.threads > 0 ? head.threads : ranks.threads();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  go_by(head.rates);
  SynthesizeParams params;
  params.method = head.method;
  params.tolerance = head.tolerance;
  params.device = head.device;
  if (params.device.kind == DeviceKind::opencl)
    params.device.number = equal_device(list_devices(), params.device.number, ranks.rank_here());
  ranks.send(0, tag_ready);
  for (Ranks::Message message = ranks.receive(); message.tag == tag_band; message = ranks.receive()) {
    BandOrder order;
    from_message(message.bytes, order);
    send_rows(ranks, order, synthesize_band(sets[size_t(order.band.set)], head.panel, order.band, params));
    ranks.send(0, tag_finished, to_message(order.index));
  }
}

}  // namespace holotrace
