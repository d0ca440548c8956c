#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holotrace/data/field.h"

namespace holotrace {

/// What a file of bands is the work of. Bands of another job never mix with it.
struct BandedJob {
  std::string description;   ///< for people: panel, waves, method
  uint64_t fingerprint = 0;  ///< of all that the bytes depend on
  size_t bands = 0;
  std::map<std::string, double> settings{};  ///< what the machine of the first run chose by: kept for those that go on
};

/// An HDF5 field file, as save_fields makes, that is written band by band, in bounded memory, and survives a kill.
///
/// Until it is whole it is PATH.partial, and PATH.partial.json, the journal, says which bands are finished. HDF5 makes
/// the file once, with a place for every sample; the samples then go straight to their places, so that no kill can
/// damage the file's structure. A band counts as finished when its samples are on the disk and after them, in one
/// rename, the journal. The room on the disk is taken at the start: a disk that is too full is told of before the work.
/// A file taken up again and finished has the bytes of one written in one go.
///
/// Not for use from several threads at once, except write_rows.
class FieldBands {
 public:
  /// Opens PATH.partial, made where there is none, or one without a journal.
  /// @param path     that the whole file will have, .h5
  /// @param headers  fields without samples that differ in wavelength alone: [wavelength]
  /// @throws Error   where the journal is of another job, another run writes the file, the disk is too full, or a file
  ///                 cannot be written
  FieldBands(const std::string& path, const std::vector<Field>& headers, const BandedJob& job);
  ~FieldBands();
  FieldBands(const FieldBands&) = delete;

  /// The job's, or of a file taken up again those of the run that began it.
  const std::map<std::string, double>& settings() const { return job_.settings; }

  bool is_finished(size_t band) const { return finished_[band]; }
  size_t finished_bands() const;

  /// Writes whole rows of a field, from `first_row` on: samples[row][column], shape (rows, nx).
  /// @throws Error  saying so where the disk is full
  void write_rows(size_t field, int first_row, int rows, const std::complex<float>* samples) const;

  /// Notes that all rows of a band are written, once they are on the disk. @throws Error as write_rows does
  void finish_band(size_t band);

  /// Gives the file its name and removes the journal. @throws Error unless all bands are finished
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
  std::vector<uint64_t> chunks_;  // where they begin in the file
  int file_ = -1;
};

}  // namespace holotrace
