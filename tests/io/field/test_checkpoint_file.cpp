#include <gtest/gtest.h>

#include <filesystem>

#include "holotrace/io/field/checkpoint_file.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

IterationState some_state() {
  IterationState state{
      .job = 0x123456789abcdef0u, .description = "2 frame(s)", .updates = 7, .numbers = {1.0 / 3, -2e30}};
  for (int k = 0; k < 3; ++k) {
    Array2D<float>& array = state.arrays.emplace_back(2, 5);
    for (size_t i = 0; i < array.size(); ++i) array.values[i] = 0.1F * float(i) + 100 * float(k);
  }
  return state;
}

TEST(CheckpointFile, AStateComesBackAsSaved) {
  const std::string path = temporary("state.h5");
  const IterationState state = some_state();
  std::filesystem::remove(path);
  EXPECT_FALSE(load_checkpoint(path, state));
  save_checkpoint(path, some_state());
  const auto loaded = load_checkpoint(path, {.job = state.job});
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->description, state.description);
  EXPECT_EQ(loaded->updates, 7);
  EXPECT_EQ(loaded->numbers, state.numbers);  // all bits
  ASSERT_EQ(loaded->arrays.size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(loaded->arrays[k].nx, 5);
    EXPECT_EQ(loaded->arrays[k].values, state.arrays[k].values);
  }
}

TEST(CheckpointFile, OfAnotherJobIsRefused) {
  const std::string path = temporary("state.h5");
  save_checkpoint(path, some_state());
  EXPECT_EQ(
      error_of([&] { load_checkpoint(path, {.job = 5, .description = "3 frame(s)"}); }),
      "expected the checkpoint of this job in " + path +
          " (3 frame(s)), got that of another one (2 frame(s)); give another file, or remove this one to begin anew");
}

TEST(CheckpointFile, OtherFilesAreRefused) {
  const IterationState state = some_state();
  const std::string text = make_file("text.h5", "not HDF5");
  EXPECT_NE(error_of([&] { load_checkpoint(text, state); }).find("expected an HDF5 file"), std::string::npos);
  const std::string field = temporary("field.h5");
  save_field(field, Field({4, 3, 8e-6}, 5e-7));
  EXPECT_NE(error_of([&] { load_checkpoint(field, state); }).find("expected a dataset \"numbers\""), std::string::npos);
  // Cut off behind its first half, as after a full disk.
  const std::string path = temporary("state.h5");
  save_checkpoint(path, state);
  const std::string bytes = read_text(path);
  const std::string cut = make_file("cut.h5", bytes.substr(0, bytes.size() / 2));
  EXPECT_NE(error_of([&] { load_checkpoint(cut, state); }), "no error");
}

TEST(CheckpointFile, NeedsArraysOfOneSize) {
  IterationState state = some_state();
  state.arrays.emplace_back(3, 5);
  EXPECT_EQ(error_of([&] { save_checkpoint(temporary("state.h5"), state); }),
            "expected arrays of one size in a state, got 5 × 2 and 5 × 3");
}

}  // namespace
}  // namespace holotrace
