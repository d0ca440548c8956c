#include "holotrace/io/field/field_bands.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_formats.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "samples are written as they lie in memory");

constexpr int chunk_rows = 128;

bool is_full(int reason) { return reason == ENOSPC || reason == EDQUOT || reason == EFBIG; }

// Writes a file or a folder entry to the disk, so that it survives a power cut. Some file systems cannot do this.
bool sync_path(const fs::path& path, int flags) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (file < 0) return false;
  const bool is_synced = fsync(file) == 0;
  close(file);
  return is_synced;
}

void sync_folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  sync_path(folder.empty() ? fs::path(".") : folder, O_DIRECTORY);
}

nlohmann::json ranges_of(const std::vector<bool>& finished) {
  nlohmann::json ranges = nlohmann::json::array();
  for (size_t i = 0; i < finished.size(); ++i) {
    if (!finished[i]) continue;
    if (i > 0 && finished[i - 1])
      ranges.back()[1] = i;
    else
      ranges.push_back({i, i});
  }
  return ranges;
}

}  // namespace

FieldBands::FieldBands(const std::string& path, const std::vector<Field>& headers, const BandedJob& job)
    : path_(path),
      partial_(path + ".partial"),
      journal_(path + ".partial.json"),
      headers_(headers),
      job_(job),
      finished_(job.bands, false) {
  require(extension_of(path) == ".h5", "expected an .h5 file for a field made in bands, got {}; change its extension",
          path);
  std::error_code ignored;
  if (is_there(journal_) && is_there(partial_)) {
    read_journal();
    open_partial();
    reserve_room();
  } else {
    fs::remove(journal_, ignored);  // left by a run that ended between its last two steps
    make_partial();
  }
}

FieldBands::~FieldBands() {
  if (file_ >= 0) close(file_);
}

size_t FieldBands::finished_bands() const { return size_t(std::count(finished_.begin(), finished_.end(), true)); }

// The lock ends with the process, however that ends. HDF5 locks the file itself while it reads, so it reads first.
void FieldBands::open_partial() {
  file_ = open(partial_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0) fail("expected to write {}, got \"{}\"; check its permissions", partial_, std::strerror(errno));
  lock();
  flock(file_, LOCK_UN);
  const Grid& grid = headers_.front().grid;
  const int of_chunk = std::min(chunk_rows, grid.ny);
  chunks_ = chunk_offsets_hdf5(partial_, headers_, of_chunk);
  const uint64_t end = chunks_.back() + uint64_t(of_chunk) * uint64_t(grid.nx) * sizeof(std::complex<float>);
  require(fs::file_size(partial_) >= end, "{}: expected {} bytes or more, got {}; the file is damaged, delete it",
          partial_, end, fs::file_size(partial_));
  lock();
}

void FieldBands::lock() const {
  require(flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK,
          "expected {} for this run alone, but another run is writing it; wait for its end, or choose another output",
          partial_);
}

void FieldBands::make_partial() {
  const Grid& grid = headers_.front().grid;
  const double bytes = double(headers_.size()) * double(grid.pixels()) * sizeof(std::complex<float>);
  std::error_code unknown;
  const fs::path folder = fs::absolute(path_).parent_path();
  const fs::space_info room = fs::space(folder, unknown);
  require(
      unknown || double(room.available) >= bytes,
      "cannot write {}: the disk is full: expected {} of room in {}, got {}; make room there or choose another folder",
      path_, format_bytes(bytes), folder.string(), format_bytes(double(room.available)));
  try {
    write_atomically(partial_, [&](const std::string& temporary) {
      create_fields_hdf5(temporary, headers_, std::min(chunk_rows, grid.ny));
    });
    open_partial();
    reserve_room();
    if (fsync(file_) != 0) fail_to_write(errno);
    write_journal();
  } catch (...) {
    std::error_code ignored;
    fs::remove(partial_, ignored);
    throw;
  }
}

// Reserves disk space for the whole file. If the file system cannot, a full disk is reported when a band is written.
void FieldBands::reserve_room() const {
  struct stat status {};
  if (fstat(file_, &status) != 0) fail_to_write(errno);
  if (fallocate(file_, 0, 0, status.st_size) != 0 && errno != EOPNOTSUPP && errno != ENOSYS) fail_to_write(errno);
}

void FieldBands::fail_to_write(int reason) const {
  const size_t kept = finished_bands();
  fail("cannot write {}: {}; make room there and give the same command again: {} of {} bands are kept", partial_,
       is_full(reason) ? fmt::format("the disk is full ({})", std::strerror(reason))
                       : std::string(std::strerror(reason)),
       kept, job_.bands);
}

void FieldBands::write_rows(size_t field, int first_row, int rows, const std::complex<float>* samples) const {
  const Grid& grid = headers_.front().grid;
  const size_t row_bytes = size_t(grid.nx) * sizeof *samples;
  const int of_chunk = std::min(chunk_rows, grid.ny), chunks = (grid.ny + of_chunk - 1) / of_chunk;
  for (int row = first_row; row < first_row + rows;) {
    const int in_chunk = row % of_chunk, count = std::min(of_chunk - in_chunk, first_row + rows - row);
    uint64_t at = chunks_[field * size_t(chunks) + size_t(row / of_chunk)] + uint64_t(in_chunk) * row_bytes;
    const char* bytes = reinterpret_cast<const char*>(samples + size_t(row - first_row) * size_t(grid.nx));
    for (size_t left = size_t(count) * row_bytes; left > 0;) {
      const ssize_t written = pwrite(file_, bytes, left, off_t(at));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail_to_write(written < 0 ? errno : ENOSPC);
      bytes += written;
      at += uint64_t(written);
      left -= size_t(written);
    }
    row += count;
  }
}

void FieldBands::finish_band(size_t band) {
  if (fdatasync(file_) != 0) fail_to_write(errno);
  finished_[band] = true;
  try {
    write_journal();
  } catch (...) {
    finished_[band] = false;
    throw;
  }
}

void FieldBands::finish() {
  require(finished_bands() == job_.bands, "expected {} finished bands in {}, got {}", job_.bands, partial_,
          finished_bands());
  std::error_code error;
  fs::rename(partial_, path_, error);
  require(!error, "expected to write {}, got \"{}\"; choose a path where you may write", path_, error.message());
  sync_folder_of(path_);
  fs::remove(journal_, error);
}

void FieldBands::write_journal() const {
  const nlohmann::ordered_json json{{"job", job_.description},
                                    {"fingerprint", fmt::format("{:016x}", job_.fingerprint)},
                                    {"bands", job_.bands},
                                    {"settings", job_.settings},
                                    {"finished", ranges_of(finished_)}};
  const std::string text = json.dump() + "\n";
  NewFile file(journal_);
  file.put(text.data(), text.size());
  file.sync();
  file.finish();
  sync_folder_of(journal_);
}

void FieldBands::read_journal() {
  const nlohmann::json json = read_metadata(journal_);
  require(metadata_text(json, journal_, "fingerprint", "") == fmt::format("{:016x}", job_.fingerprint) &&
              metadata_number(json, journal_, "bands") == double(job_.bands),
          "expected {} to be an unfinished run of this job ({}), got one of another ({}); finish that one by its own "
          "command, or delete {}",
          partial_, job_.description, metadata_text(json, journal_, "job", "unknown"), partial_);
  if (const auto settings = json.find("settings"); settings != json.end() && settings->is_object()) {
    job_.settings.clear();
    for (const auto& item : settings->items())
      job_.settings[item.key()] = metadata_number(*settings, journal_, item.key().c_str());
  }
  const auto ranges = json.find("finished");
  const auto is_band = [&](const nlohmann::json& n) { return n.is_number_unsigned() && n.get<size_t>() < job_.bands; };
  const auto is_range = [&](const nlohmann::json& r) {
    return r.is_array() && r.size() == 2 && is_band(r[0]) && is_band(r[1]);
  };
  require(ranges != json.end() && ranges->is_array() && std::all_of(ranges->begin(), ranges->end(), is_range),
          "{}: expected ranges of bands in \"finished\", got other values; delete it and {}", journal_, partial_);
  for (const auto& range : *ranges)
    for (size_t i = range[0]; i <= range[1].get<size_t>(); ++i) finished_[i] = true;
}

}  // namespace holotrace
