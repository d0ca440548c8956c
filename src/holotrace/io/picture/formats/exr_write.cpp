#include <ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <stdexcept>

#include "holotrace/base/error.h"
#include "holotrace/base/thread_count.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/exr_threads.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

class FileStream : public Imf::OStream {
 public:
  FileStream(const std::string& path, NewFile& file) : OStream(path.c_str()), file_(file) {}

  void write(const char bytes[], int size) override {
    if (!file_.put(bytes, size_t(size))) throw std::runtime_error("cannot write");
  }
  uint64_t tellp() override { return uint64_t(file_.tell()); }
  void seekp(uint64_t place) override { file_.seek(int64_t(place)); }

 private:
  NewFile& file_;
};

void write_pixels(FileStream& stream, const ExrHeader& picture, const float* samples) {
  Imf::Header header(picture.columns, picture.rows);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : picture.texts) header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : picture.numbers) header.insert(name, Imf::DoubleAttribute(number));
  const size_t pixel = picture.channels.size() * sizeof(float);
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < picture.channels.size(); ++c) {
    header.channels().insert(picture.channels[c], Imf::Channel(Imf::FLOAT));
    buffer.insert(picture.channels[c],
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(samples + c)),  // only read
                             pixel, pixel * size_t(picture.columns)));
  }
  Imf::OutputFile file(stream, header, thread_count());
  file.setFrameBuffer(buffer);
  file.writePixels(picture.rows);
}

}  // namespace

void write_exr(const std::string& path, const ExrHeader& header, const float* samples) {
  NewFile file(path);
  FileStream stream(path, file);
  bool is_written = false;
  try {
    start_exr_threads();
    write_pixels(stream, header, samples);
    is_written = true;
  } catch (const std::exception&) {
    is_written = false;
  }
  file.check();
  require(is_written, "expected to write {} as an EXR of {} × {} pixels, but it cannot hold them; use fewer pixels",
          path, header.columns, header.rows);
  file.finish();
}

}  // namespace holotrace
