#pragma once

#include <hdf5.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/io/files/file.h"

// HDF5's handles, attributes and errors. Only the files of this room use it.

namespace holotrace {

/// An HDF5 identifier that is closed by the function of its kind.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  operator hid_t() const { return id_; }
  bool valid() const { return id_ >= 0; }
  herr_t close() { return close_(std::exchange(id_, -1)); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Turns off HDF5's printing of errors; here they become an Error.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Silence(const Silence&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// @throws Error, naming the file, unless `holds`
void require_written(bool holds, const std::string& path);

/// Writes to the disk what HDF5 still holds, and closes the file. @throws Error, naming the file, if it cannot
void close_written(Handle& file, const std::string& path);

/// An empty file in the format of HDF5 1.8 and later, which has checksums, so that damage is detected.
hid_t create_hdf5(const std::string& path);

/// Opens a dataset of a file. libhdf5 crashes at some damaged files: read in a child process
/// (io/files/child_process.h).
/// @param or_complex  if no dataset has that name, take the only one of complex numbers
/// @throws Error, naming the file, if it is not HDF5, has no such dataset, or has it in another file and that is refused
class Hdf5Dataset {
 public:
  Hdf5Dataset(const std::string& path, const char* name, Outside outside, bool or_complex = false);
  operator hid_t() const { return data_; }

  /// The numbers of an attribute or, if there is none, of a dataset of that name beside this one, as MATLAB writes a
  /// variable; empty if there is neither.
  std::vector<double> numbers(const char* name) const;

  /// The values of metadata that it has, as such attributes or datasets.
  /// @param pattern  as in from_flat_metadata
  /// @throws Error   for a text that is another kind of value
  nlohmann::json metadata(const nlohmann::ordered_json& pattern, const std::string& path) const;

  /// Rows of one chunk, the last but `after` of its dimensions; 1 if the dataset is not stored in chunks.
  hsize_t chunk_rows(int after) const;

  /// Bytes of one chunk; 0 if the dataset is not stored in chunks.
  double chunk_bytes() const;

 private:
  std::vector<hsize_t> chunk() const;
  Handle file_, access_, data_;
};

/// Names of the parts of a complex number.
struct ComplexNames {
  const char *real = "r", *imaginary = "i";  ///< as h5py has them
};

/// The names that a type of a file has for them: {r, i}, MATLAB's {real, imag} or {re, im}; none for other types.
std::optional<ComplexNames> complex_names(hid_t type);

/// The type of complex samples, each part of `bytes` bytes of the type `real`.
hid_t complex_type(size_t bytes, hid_t real, const ComplexNames& names = {});

void write_number(hid_t object, const char* name, double value, const std::string& path);

/// Metadata as attributes: numbers, texts, and lists of numbers with one dimension.
void write_attributes(hid_t object, const nlohmann::ordered_json& metadata, const std::string& path);
void write_word(hid_t object, const char* name, const std::string& value, const std::string& path);

/// The number of an attribute. @throws Error if it is missing or of another kind
double read_number(hid_t object, const char* name, const std::string& path);
std::string read_word(hid_t object, const char* name, const std::string& path);

/// @throws Error if the file holds fewer than `samples` samples of a dataset that is stored in one piece, or so few bytes
///         in chunks that no compression explains it
void require_all_samples(hid_t data, double samples, const std::string& path);

}  // namespace holotrace
