#include "holotrace/io/field/hdf5_access.h"

#include <algorithm>
#include <array>

#include "holotrace/base/error.h"
#include "holotrace/io/field/metadata.h"
#include "holotrace/io/files/file_kind.h"

namespace holotrace {

namespace {

// HDF5 closes at exit what is still open, and crashes on a file whose writing failed on a full disk. All files are closed
// where they are used, so it need not. This counts only before the first call of the library.
[[maybe_unused]] const herr_t nothing_at_exit = H5dont_atexit();

void write_attribute(hid_t object, const char* name, const double* values, hid_t shape, const std::string& path) {
  const Handle space(shape, H5Sclose);
  const Handle attribute(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require_written(attribute.valid() && H5Awrite(attribute, H5T_NATIVE_DOUBLE, values) >= 0, path);
}

/// The name of a dataset, without the slash of its folder.
std::string name_of(hid_t object) {
  std::array<char, 256> name{};
  H5Iget_name(object, name.data(), name.size());
  return name[0] == '/' ? name.data() + 1 : name.data();
}

herr_t refuse_link(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

// How links to other files are followed.
hid_t access_to_links(Outside outside) {
  const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  if (outside == Outside::refused) H5Pset_elink_cb(access, refuse_link, nullptr);
  return access;
}

// The dataset to open: that of the name, or the only one of complex numbers beside it.
std::string name_or_only_complex(hid_t file, const std::string& name) {
  if (file < 0 || H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0) return name;
  std::vector<std::string> names;
  const auto visit = [](hid_t group, const char* one, const H5L_info_t* link, void* list) -> herr_t {
    if (link->type != H5L_TYPE_HARD) return 0;
    const Handle object(H5Oopen(group, one, H5P_DEFAULT), H5Oclose);
    if (H5Iget_type(object) != H5I_DATASET) return 0;
    const Handle type(H5Dget_type(object), H5Tclose);
    if (complex_names(type)) static_cast<std::vector<std::string>*>(list)->push_back(one);
    return 0;
  };
  H5Literate(file, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, visit, &names);
  return names.size() == 1 ? names.front() : name;
}

}  // namespace

void require_written(bool holds, const std::string& path) {
  require(holds, "expected to write {}, but HDF5 could not; check the room and the permissions there", path);
}

void close_written(Handle& file, const std::string& path) {
  const bool is_flushed = H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
  require_written(file.close() >= 0 && is_flushed, path);
}

hid_t create_hdf5(const std::string& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);  // the same data give the same bytes
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
  require_written(file >= 0, path);
  return file;
}

Hdf5Dataset::Hdf5Dataset(const std::string& path, const char* name, Outside outside, bool or_complex)
    : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose),
      access_(access_to_links(outside), H5Pclose),
      data_(file_.valid()
                ? H5Dopen2(file_, (or_complex ? name_or_only_complex(file_, name) : std::string(name)).c_str(), access_)
                : -1,
            H5Dclose) {
  if (!file_.valid()) {
    const std::string kind = known_kind_of_file(path);
    fail("{}: expected an HDF5 file, got {}", path,
         kind.empty() || kind.find("HDF5") != std::string::npos ? "other bytes or a truncated file; write it again"
                                                                : kind);
  }
  H5L_info_t link{};
  const bool is_link = H5Lget_info(file_, name, &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_EXTERNAL;
  require(data_.valid() || !is_link, "{}: expected the dataset \"{}\", got a link to another file{}", path, name,
          outside == Outside::refused ? "; copy it into this one, or give --allow-outside"
                                      : " that cannot be read; check its path");
  require(data_.valid(), "{}: expected a dataset \"{}\", which is missing; is this another kind of HDF5 file?", path,
          name);
  const Handle properties(H5Dget_create_plist(data_), H5Pclose);
  const bool is_elsewhere = H5Pget_external_count(properties) > 0 || H5Pget_layout(properties) == H5D_VIRTUAL;
  require(!is_elsewhere || outside == Outside::allowed,
          "{}: expected the samples of \"{}\" in this file, but they are in others; copy them into it, or give "
          "--allow-outside",
          path, name);
}

std::vector<hsize_t> Hdf5Dataset::chunk() const {
  const Handle properties(H5Dget_create_plist(data_), H5Pclose);
  if (H5Pget_layout(properties) != H5D_CHUNKED) return {};
  std::array<hsize_t, H5S_MAX_RANK> shape{};
  const int rank = H5Pget_chunk(properties, int(shape.size()), shape.data());
  return {shape.begin(), shape.begin() + std::clamp(rank, 0, int(shape.size()))};
}

hsize_t Hdf5Dataset::chunk_rows(int after) const {
  const std::vector<hsize_t> shape = chunk();
  const auto dimensions = size_t(after) + 1;
  return shape.size() < dimensions ? 1 : std::max<hsize_t>(shape[shape.size() - dimensions], 1);
}

double Hdf5Dataset::chunk_bytes() const {
  const std::vector<hsize_t> shape = chunk();
  const Handle type(H5Dget_type(data_), H5Tclose);
  double bytes = shape.empty() ? 0 : double(H5Tget_size(type));
  for (const hsize_t n : shape) bytes *= double(n);
  return bytes;
}

std::vector<double> Hdf5Dataset::numbers(const char* name) const {
  const bool is_attribute = H5Aexists(data_, name) > 0;
  if (!is_attribute && H5Lexists(file_, name, H5P_DEFAULT) <= 0) return {};
  const Handle object(is_attribute ? H5Aopen(data_, name, H5P_DEFAULT) : H5Dopen2(file_, name, access_),
                      is_attribute ? H5Aclose : H5Dclose);
  const Handle space(is_attribute ? H5Aget_space(object) : H5Dget_space(object), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (count < 1 || count > 1 << 20) return {};
  std::vector<double> values(static_cast<size_t>(count));
  const herr_t status = is_attribute ? H5Aread(object, H5T_NATIVE_DOUBLE, values.data())
                                     : H5Dread(object, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  return status >= 0 ? values : std::vector<double>();
}

nlohmann::json Hdf5Dataset::metadata(const nlohmann::ordered_json& pattern, const std::string& path) const {
  return from_flat_metadata(
      pattern, [&](const std::string& name, const nlohmann::ordered_json& like) -> nlohmann::json {
        if (like.is_string()) {
          if (H5Aexists(data_, name.c_str()) <= 0) return nullptr;
          return read_word(data_, name.c_str(), path);
        }
        const std::vector<double> values = numbers(name.c_str());
        if (values.empty()) return nullptr;
        return like.is_array() || values.size() > 1 ? nlohmann::json(values) : nlohmann::json(values[0]);
      });
}

std::optional<ComplexNames> complex_names(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2) return std::nullopt;
  const auto is_number = [&](const char* part) {
    const int index = H5Tget_member_index(type, part);
    const H5T_class_t kind = index < 0 ? H5T_NO_CLASS : H5Tget_member_class(type, unsigned(index));
    return kind == H5T_FLOAT || kind == H5T_INTEGER;
  };
  for (const ComplexNames& names : {ComplexNames{}, ComplexNames{"real", "imag"}, ComplexNames{"re", "im"}})
    if (is_number(names.real) && is_number(names.imaginary)) return names;
  return std::nullopt;
}

hid_t complex_type(size_t bytes, hid_t real, const ComplexNames& names) {
  const hid_t type = H5Tcreate(H5T_COMPOUND, 2 * bytes);
  H5Tinsert(type, names.real, 0, real);
  H5Tinsert(type, names.imaginary, bytes, real);
  return type;
}

void write_number(hid_t object, const char* name, double value, const std::string& path) {
  write_attribute(object, name, &value, H5Screate(H5S_SCALAR), path);
}

void write_attributes(hid_t object, const nlohmann::ordered_json& metadata, const std::string& path) {
  flat_metadata(metadata, [&](const std::string& name, const nlohmann::ordered_json& value) {
    if (value.is_string()) return write_word(object, name.c_str(), value, path);
    if (value.is_number()) return write_number(object, name.c_str(), value, path);
    const std::vector<double> values = value;
    const hsize_t count = values.size();
    write_attribute(object, name.c_str(), values.data(), H5Screate_simple(1, &count, nullptr), path);
  });
}

void write_word(hid_t object, const char* name, const std::string& value, const std::string& path) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);  // h5py reads it as str
  H5Tset_cset(type, H5T_CSET_UTF8);
  const char* text = value.c_str();
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require_written(attribute.valid() && H5Awrite(attribute, type, &text) >= 0, path);
}

double read_number(hid_t object, const char* name, const std::string& path) {
  require(H5Aexists(object, name) > 0,
          "{}: expected the attribute \"{}\" of \"{}\", which is missing; add it, in SI units", path, name,
          name_of(object));
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  double value = 0;
  require(H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0,
          "{}: expected a number for \"{}\", got another kind", path, name);
  return value;
}

std::string read_word(hid_t object, const char* name, const std::string& path) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  require(H5Tget_class(type) == H5T_STRING, "{}: expected a text for \"{}\", got another kind", path, name);
  if (H5Tis_variable_str(type) > 0) {  // as h5py writes str
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory, H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type));
    char* text = nullptr;
    require(H5Aread(attribute, memory, &text) >= 0 && text, "{}: expected a text for \"{}\", got none", path, name);
    const std::string value(text);
    H5free_memory(text);
    return value;
  }
  std::vector<char> text(H5Tget_size(type) + 1, '\0');
  require(H5Aread(attribute, type, text.data()) >= 0, "{}: expected a text for \"{}\", got none", path, name);
  return text.data();
}

void require_all_samples(hid_t data, double samples, const std::string& path) {
  const Handle properties(H5Dget_create_plist(data), H5Pclose);
  const Handle type(H5Dget_type(data), H5Tclose);
  const double stored = double(H5Dget_storage_size(data)), wanted = double(H5Tget_size(type)) * samples;
  const H5D_layout_t layout = H5Pget_layout(properties);
  constexpr double most_compression = 4096, free_bytes = 1 << 20;  // gzip reaches 1032 with zeros alone
  const bool has_all = layout == H5D_CONTIGUOUS ? stored == wanted
                       : layout == H5D_CHUNKED  ? wanted <= most_compression * stored + free_bytes
                                                : true;
  require(has_all, "{}: expected {} samples, got {} bytes of them; the file is truncated or damaged", path, samples,
          stored);
}

}  // namespace holotrace
