#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holotrace/data/field.h"

namespace holotrace {

/// The job that a file of bands belongs to. Bands of different jobs never mix.
struct BandedJob {
  std::string description;   ///< text that describes the job: panel, waves, method
  uint64_t fingerprint = 0;  ///< hash of all inputs that the bytes depend on
  size_t bands = 0;
  std::map<std::string, double> settings{};  ///< settings that depend on the first run's machine; later runs reuse them
};

/// An HDF5 field file, as save_fields writes it, that is written band by band, in bounded memory, and survives a kill.
///
/// While incomplete it is PATH.partial; PATH.partial.json, the journal, lists the finished bands. HDF5 creates
/// the file once, with a place for every sample. The samples are then written directly to their places, so a kill
/// cannot damage the file's structure. A band is finished when its samples are on the disk and then, by a
/// rename, the journal. Disk space is reserved at the start: a disk that is too full is reported before the work.
/// A file that was resumed and finished has the same bytes as one written in one run.
///
/// Only write_rows may be called from several threads at once.
class FieldBands {
 public:
  /// Opens PATH.partial; makes it if it is missing or has no journal.
  /// @param path     path of the finished file, .h5
  /// @param headers  fields without samples that differ only in wavelength: [wavelength]
  /// @throws Error   if the journal is of another job, another run writes the file, the disk is too full, or a file
  ///                 cannot be written
  FieldBands(const std::string& path, const std::vector<Field>& headers, const BandedJob& job);
  ~FieldBands();
  FieldBands(const FieldBands&) = delete;

  /// The settings of the job; for a resumed file, those of the run that began it.
  const std::map<std::string, double>& settings() const { return job_.settings; }

  bool is_finished(size_t band) const { return finished_[band]; }
  size_t finished_bands() const;  ///< number of finished bands

  /// Writes whole rows of a field, from `first_row` on: samples[row][column], shape (rows, nx) [√(W/m²)].
  /// @throws Error  if the disk is full
  void write_rows(size_t field, int first_row, int rows, const std::complex<float>* samples) const;

  /// Records that all rows of a band are written, once they are on the disk. @throws Error as write_rows does
  void finish_band(size_t band);

  /// Renames the file to its final name and removes the journal. @throws Error unless all bands are finished
  void finish();

 private:
  void open_partial();
  void lock() const;
  void make_partial();
  void read_journal();
  void write_journal() const;
  void reserve_room() const;
  [[noreturn]] void fail_to_write(int reason) const;

  std::string path_, partial_, journal_;
  std::vector<Field> headers_;
  BandedJob job_;
  std::vector<bool> finished_;
  std::vector<uint64_t> chunks_;  // offsets of the chunks in the file [bytes]
  int file_ = -1;
};

}  // namespace holotrace
