#pragma once

#include <png.h>

#include <csetjmp>

namespace holotrace {

/// What libpng keeps while it reads or writes a file. It says nothing, and jumps at errors.
class PngSession {
 public:
  enum Direction { reading, writing };

  explicit PngSession(Direction direction) : direction_(direction) {
    const auto jump = [](png_structp p, png_const_charp) { png_longjmp(p, 1); };
    const auto be_silent = [](png_structp, png_const_charp) {};
    const auto create = direction == reading ? png_create_read_struct : png_create_write_struct;
    png = create(PNG_LIBPNG_VER_STRING, nullptr, jump, be_silent);
    if (png) info = png_create_info_struct(png);
  }
  ~PngSession() {
    if (direction_ == reading)
      png_destroy_read_struct(&png, &info, nullptr);
    else
      png_destroy_write_struct(&png, &info);
  }
  PngSession(const PngSession&) = delete;
  PngSession& operator=(const PngSession&) = delete;

  /// Calls libpng, which jumps out of `work` at an error: `work` must not own anything. @return whether there was none
  template <class Work>
  [[gnu::noinline]] bool succeeds(const Work& work) const {
    if (setjmp(png_jmpbuf(png))) return false;
    work();
    return true;
  }

  png_structp png = nullptr;
  png_infop info = nullptr;  ///< none if libpng of another version was found

 private:
  Direction direction_;
};

}  // namespace holotrace
