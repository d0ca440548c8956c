#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>

#include "holotrace/base/random.h"
#include "holotrace/io/field/field_bands.h"
#include "holotrace/io/field/field_file.h"
#include "support/program.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

namespace fs = std::filesystem;

// Not a multiple of the 128 rows of a chunk; two wavelengths.
std::vector<Field> make_fields(size_t count = 2) {
  std::vector<Field> fields;
  CounterRandom random(3, 0, 0);
  for (size_t n = 0; n < count; ++n) {
    fields.emplace_back(Grid{37, 300, 8e-6}, n == 0 ? 532e-9 : 638e-9);
    fields.back().label.name = "EL";
    fields.back().label.frame = 2;
    for (auto& u : fields.back().samples.values) u = {float(random.uniform()), float(random.uniform())};
  }
  return fields;
}

std::vector<Field> headers_of(std::vector<Field> fields) {
  for (Field& field : fields) field.samples = {};
  return fields;
}

constexpr int band_rows = 100;  // ends within chunks

BandedJob job_of(const std::vector<Field>& fields, uint64_t fingerprint = 5) {
  return {.description = "a test", .fingerprint = fingerprint, .bands = fields.size() * 3};
}

void write_band(FieldBands& file, const std::vector<Field>& fields, size_t band) {
  const size_t plane = band / 3;
  const int row = int(band % 3) * band_rows;
  file.write_rows(plane, row, band_rows, fields[plane].samples.row(row));
  file.finish_band(band);
}

// Makes the missing bands, up to `until`.
void write_missing(FieldBands& file, const std::vector<Field>& fields, size_t until) {
  for (size_t band = 0; band < until; ++band)
    if (!file.is_finished(band)) write_band(file, fields, band);
}

std::string unbroken(const std::vector<Field>& fields, const char* name) {
  const std::string path = temporary(name);
  FieldBands file(path, headers_of(fields), job_of(fields));
  write_missing(file, fields, fields.size() * 3);
  file.finish();
  return path;
}

TEST(FieldBands, AreAFieldFileLikeAnyOther) {
  for (const size_t count : {1u, 2u}) {
    const std::vector<Field> fields = make_fields(count);
    const std::string path = unbroken(fields, "f.h5");
    const std::vector<Field> loaded = load_fields(path);
    ASSERT_EQ(loaded.size(), count);
    for (size_t n = 0; n < count; ++n) {
      EXPECT_EQ(loaded[n].samples.values, fields[n].samples.values);
      EXPECT_EQ(loaded[n].grid, fields[n].grid);
      EXPECT_EQ(loaded[n].wavelength, fields[n].wavelength);
      EXPECT_EQ(loaded[n].label.name, "EL");
      EXPECT_EQ(loaded[n].label.frame, 2u);
    }
    EXPECT_FALSE(fs::exists(path + ".partial"));
    EXPECT_FALSE(fs::exists(path + ".partial.json"));
  }
}

TEST(FieldBands, ResumedInAnyOrderHaveTheSameBytes) {
  const std::vector<Field> fields = make_fields();
  const std::string whole = unbroken(fields, "whole.h5"), path = temporary("f.h5");
  for (const size_t band : {4u, 1u, 5u, 0u, 3u}) {  // a separate run for each band
    FieldBands file(path, headers_of(fields), job_of(fields));
    EXPECT_FALSE(file.is_finished(band));
    write_band(file, fields, band);
    EXPECT_TRUE(file.is_finished(band));
    EXPECT_FALSE(fs::exists(path)) << "the file has its name once it is whole";
  }
  FieldBands file(path, headers_of(fields), job_of(fields));
  EXPECT_EQ(file.finished_bands(), 5u);
  EXPECT_EQ(error_of([&] { file.finish(); }), "expected 6 finished bands in " + path + ".partial, got 5");
  write_missing(file, fields, 6);
  file.finish();
  EXPECT_EQ(bytes_of(path), bytes_of(whole));
}

TEST(FieldBands, AHalfWrittenBandIsWrittenAgain) {
  const std::vector<Field> fields = make_fields(1);
  const std::string whole = unbroken(fields, "whole.h5"), path = temporary("f.h5");
  {
    FieldBands file(path, headers_of(fields), job_of(fields));
    write_band(file, fields, 0);
    const std::vector<std::complex<float>> wrong(37 * 50, 7.0f);
    file.write_rows(0, 100, 50, wrong.data());  // then the run is killed
  }
  FieldBands file(path, headers_of(fields), job_of(fields));
  EXPECT_TRUE(file.is_finished(0));
  EXPECT_FALSE(file.is_finished(1));
  write_missing(file, fields, 3);
  file.finish();
  EXPECT_EQ(bytes_of(path), bytes_of(whole));
}

TEST(FieldBands, LeftoversOfEveryStepOfARunAreNoObstacle) {
  const std::vector<Field> fields = make_fields(1);
  const std::string whole = unbroken(fields, "whole.h5"), path = temporary("f.h5");
  // A file without a journal: killed while making it. A journal without a file: killed after the last rename.
  make_file("f.h5.partial", "no HDF5 file");
  fs::remove(path + ".partial.json");
  {
    FieldBands file(path, headers_of(fields), job_of(fields));
    write_missing(file, fields, 3);
    fs::rename(path + ".partial", path);
  }
  ASSERT_TRUE(fs::exists(path + ".partial.json"));
  FieldBands file(path, headers_of(fields), job_of(fields));
  EXPECT_EQ(file.finished_bands(), 0u);
  write_missing(file, fields, 3);
  file.finish();
  EXPECT_EQ(bytes_of(path), bytes_of(whole));
}

TEST(FieldBands, ResumedKeepTheSettingsOfTheFirstRun) {
  const std::vector<Field> fields = make_fields(1);
  const std::string path = temporary("f.h5");
  BandedJob job = job_of(fields);
  job.settings = {{"rate", 0.1}};
  { FieldBands file(path, headers_of(fields), job); }
  job.settings = {{"rate", 7}};
  const FieldBands file(path, headers_of(fields), job);
  EXPECT_EQ(file.settings(), (std::map<std::string, double>{{"rate", 0.1}})) << "to the last bit";
}

TEST(FieldBands, OfAnotherJobAreRefused) {
  const std::vector<Field> fields = make_fields(1);
  const std::string path = temporary("f.h5");
  { FieldBands file(path, headers_of(fields), job_of(fields, 5)); }
  EXPECT_EQ(error_of([&] { FieldBands(path, headers_of(fields), job_of(fields, 6)); }),
            "expected " + path +
                ".partial to be an unfinished run of this job (a test), got one of another (a test); " +
                "finish that one by its own command, or delete " + path + ".partial");
}

TEST(FieldBands, AreWrittenByOneRunAtATime) {
  const std::vector<Field> fields = make_fields(1);
  const std::string path = temporary("f.h5");
  const FieldBands file(path, headers_of(fields), job_of(fields));
  EXPECT_EQ(error_of([&] { FieldBands(path, headers_of(fields), job_of(fields)); }),
            "expected " + path + ".partial for this run alone, but another run is writing it; wait for its end, or " +
                "choose another output");
}

TEST(FieldBands, DamagedFilesAndJournalsAreRefused) {
  const std::vector<Field> fields = make_fields(1);
  const std::string path = temporary("f.h5");
  const auto open_again = [&] { FieldBands(path, headers_of(fields), job_of(fields)); };
  { FieldBands file(path, headers_of(fields), job_of(fields)); }
  fs::resize_file(path + ".partial", 20000);
  EXPECT_NE(error_of(open_again), "no error");
  make_file("f.h5.partial.json", "{\"fingerprint\": \"0000000000000005\", \"bands\": 3, \"finished\": [[0, 9]]}");
  EXPECT_EQ(error_of(open_again), path + ".partial.json: expected ranges of bands in \"finished\", got other values; " +
                                      "delete it and " + path + ".partial");
  EXPECT_EQ(error_of([&] { FieldBands(temporary("f.npy"), headers_of(fields), job_of(fields)); }).substr(0, 51),
            "expected an .h5 file for a field made in bands, got");
}

// A limit on the size of files: what lies beyond it cannot be written, as on a full disk.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(FieldBands, AFullDiskIsReportedAndFinishedBandsStay) {
  const std::vector<Field> fields = make_fields(1);
  const std::string whole = unbroken(fields, "whole.h5"), path = temporary("f.h5");
  {
    FieldBands file(path, headers_of(fields), job_of(fields));
    write_band(file, fields, 0);
    const FileLimit limit(40000);  // 100 rows are 29600 bytes
    EXPECT_EQ(error_of([&] { write_band(file, fields, 1); }),
              "cannot write " + path +
                  ".partial: the disk is full (File too large); make room there and give the same " +
                  "command again: 1 of 3 bands are kept");
  }
  FieldBands file(path, headers_of(fields), job_of(fields));
  EXPECT_EQ(file.finished_bands(), 1u);
  write_missing(file, fields, 3);
  file.finish();
  EXPECT_EQ(bytes_of(path), bytes_of(whole));
}

TEST(FieldBands, LargerThanTheDiskAreRefusedAtTheStart) {
  std::vector<Field> headers(1);
  headers[0].grid = {1 << 24, 1 << 24, 1e-6};  // 2 petabytes
  headers[0].wavelength = 532e-9;
  const std::string path = temporary("f.h5");
  const std::string error = error_of([&] { FieldBands(path, headers, job_of(headers)); });
  EXPECT_NE(error.find("the disk is full: expected 2048 TiB of room in "), std::string::npos) << error;
  EXPECT_TRUE(fs::is_empty(fs::path(path).parent_path())) << "nothing is left behind";
}

}  // namespace
}  // namespace holotrace::test
