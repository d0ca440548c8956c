#include "holotrace/io/picture/image_output.h"

#include <OpenImageIO/filesystem.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {
namespace {

// What OpenImageIO writes to, instead of a file that it opens itself.
class Destination : public OIIO::Filesystem::IOProxy {
 public:
  Destination(const std::string& path, NewFile& file) : IOProxy(path, Write), file_(file) {}

  const char* proxytype() const override { return "file"; }
  bool opened() const override { return true; }
  int64_t tell() override { return file_.tell(); }
  bool seek(int64_t place) override { return file_.seek(place); }
  size_t write(const void* bytes, size_t size) override {
    const size_t written = file_.put(bytes, size) ? size : 0;
    size_ = std::max(size_, size_t(file_.tell()));
    return written;
  }
  size_t size() const override { return size_; }

 private:
  NewFile& file_;
  size_t size_ = 0;
};

}  // namespace

void write_image_file(const std::string& path,
                      const std::function<bool(OIIO::ImageOutput& output, const std::string& name)>& write) {
  NewFile file(path);
  Destination destination(path, file);
  auto output = OIIO::ImageOutput::create(path);
  require(output != nullptr, "expected to write {}, got \"{}\"; choose .png or .exr", path, OIIO::geterror());
  output->set_ioproxy(&destination);
  const bool is_written = write(*output, path);
  const std::string reason = output->geterror();
  output.reset();
  file.check();  // the system's reason says more than the library's
  require(is_written, "expected to write {}, got \"{}\"; check the room and the permissions there", path, reason);
  file.finish();
}

void write_image_file(const std::string& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type,
                      const void* values) {
  write_image_file(path, [&](OIIO::ImageOutput& output, const std::string& name) {
    return output.open(name, spec) && output.write_image(type, values) && output.close();
  });
}

}  // namespace holotrace
