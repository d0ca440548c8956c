#include <ImathBox.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"

namespace holotrace {
namespace {

/// Gives OpenEXR's pool of threads, which has none at first, as many as all else here has.
void start_exr_threads() {
  if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(thread_count());
}

class SourceStream : public Imf::IStream {
 public:
  explicit SourceStream(ByteSource& source) : IStream(source.name().c_str()), source_(source) {}

  bool read(char to[], int size) override {
    if (!source_.read_all(to, size_t(std::max(size, 0)))) throw std::runtime_error("end of file");
    return source_.place() < source_.size();
  }
  uint64_t tellg() override { return source_.place(); }
  void seekg(uint64_t place) override { source_.seek(place); }

 private:
  ByteSource& source_;
};

// The order of channels in a pixel: those without a layer first, and in each layer R, G, B, Y, A and then the rest.
std::tuple<std::string, int, std::string> rank(const std::string& name) {
  constexpr std::array<const char*, 5> first{"R", "G", "B", "Y", "A"};
  const size_t dot = name.rfind('.');
  const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
  const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
  return {layer, int(std::find(first.begin(), first.end(), last) - first.begin()), last};
}

void read_attributes(const Imf::Header& from, PictureHeader& header) {
  for (auto it = from.begin(); it != from.end(); ++it) {
    const Imf::Attribute& value = it.attribute();
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&value))
      header.texts[it.name()] = text->value();
    else if (const auto* real = dynamic_cast<const Imf::DoubleAttribute*>(&value))
      header.numbers[it.name()] = real->value();
    else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(&value))
      header.numbers[it.name()] = single->value();
  }
}

// Whether the channels are those of a flat picture with one sample in each pixel.
bool read_channels(const Imf::Header& from, PictureHeader& header) {
  if (from.hasType() && (from.type() == Imf::DEEPSCANLINE || from.type() == Imf::DEEPTILE)) return false;
  for (auto it = from.channels().begin(); it != from.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) return false;
    header.channels.emplace_back(it.name());
  }
  std::sort(header.channels.begin(), header.channels.end(),
            [](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return !header.channels.empty();
}

void read_samples(Imf::MultiPartInputFile& file, Picture& picture) {
  Imf::InputPart part(file, 0);
  const Imath::Box2i window = part.header().dataWindow();
  auto& values = std::get<std::vector<float>>(picture.samples);
  const size_t pixel = picture.channels.size() * sizeof(float);
  Imf::FrameBuffer buffer;
  for (size_t c = 0; c < picture.channels.size(); ++c)
    buffer.insert(picture.channels[c],
                  Imf::Slice::Make(Imf::FLOAT, values.data() + c, window, pixel, pixel * size_t(picture.columns)));
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  picture.is_complete = true;
}

}  // namespace

std::optional<Picture> read_exr(ByteSource& source, const HeaderCheck& wants) {
  SourceStream stream(source);
  std::unique_ptr<Imf::MultiPartInputFile> file;
  Picture picture;
  picture.type = SampleType::floats;
  try {
    start_exr_threads();
    file = std::make_unique<Imf::MultiPartInputFile>(stream, thread_count());
    const Imf::Header& header = file->header(0);
    const Imath::Box2i window = header.dataWindow();
    const int64_t columns = int64_t(window.max.x) - window.min.x + 1, rows = int64_t(window.max.y) - window.min.y + 1;
    if (columns < 1 || rows < 1 || columns > INT32_MAX || rows > INT32_MAX || !read_channels(header, picture))
      return std::nullopt;
    picture.columns = int(columns);
    picture.rows = int(rows);
    read_attributes(header, picture);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  if (!wants(picture)) return picture;
  picture.samples = samples_for(picture);
  try {
    read_samples(*file, picture);
  } catch (const std::exception&) {
    picture.is_complete = false;
  }
  return picture;
}

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
