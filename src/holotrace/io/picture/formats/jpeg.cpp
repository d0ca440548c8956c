#include <cstdio>
// jpeglib.h needs stdio.h before it.
#include <jerror.h>
#include <jpeglib.h>

#include <array>
#include <csetjmp>

#include "holotrace/base/error.h"
#include "holotrace/io/files/new_file.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/formats/header_fields.h"

namespace holotrace {
namespace {

struct Errors : jpeg_error_mgr {
  std::jmp_buf place;
};

struct Source : jpeg_source_mgr {
  ByteSource* bytes = nullptr;
  std::array<JOCTET, 1 << 14> buffer;
};

[[noreturn]] void jump(j_common_ptr info) { std::longjmp(static_cast<Errors*>(info->err)->place, 1); }

boolean fill(j_decompress_ptr info) {
  auto& source = *static_cast<Source*>(info->src);
  source.bytes_in_buffer = source.bytes->read(source.buffer.data(), source.buffer.size());
  source.next_input_byte = source.buffer.data();
  if (source.bytes_in_buffer == 0) jump(reinterpret_cast<j_common_ptr>(info));  // truncated
  return TRUE;
}

void skip(j_decompress_ptr info, long count) {
  auto& source = *static_cast<Source*>(info->src);
  if (count <= 0) return;
  if (size_t(count) <= source.bytes_in_buffer) {
    source.next_input_byte += count;
    source.bytes_in_buffer -= size_t(count);
  } else {
    source.bytes->seek(source.bytes->place() + size_t(count) - source.bytes_in_buffer);
    source.bytes_in_buffer = 0;
  }
}

// A small file may ask for the work of any number of scans of a large picture.
void limit_scans(j_common_ptr info) {
  constexpr int most_scans = 500;
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > most_scans) jump(info);
}

class Reader {
 public:
  explicit Reader(ByteSource& bytes) {
    info.err = jpeg_std_error(&errors);
    errors.error_exit = jump;
    errors.emit_message = [](j_common_ptr common, int level) {
      if (level < 0 && common->err->msg_code == JWRN_HIT_MARKER) jump(common);  // rows are missing
    };
    errors.output_message = [](j_common_ptr) {};
    source.bytes = &bytes;
    source.init_source = [](j_decompress_ptr) {};
    source.fill_input_buffer = fill;
    source.skip_input_data = skip;
    source.resync_to_restart = jpeg_resync_to_restart;
    source.term_source = [](j_decompress_ptr) {};
    source.bytes_in_buffer = 0;
    source.next_input_byte = nullptr;
    progress.progress_monitor = limit_scans;
  }
  ~Reader() { jpeg_destroy_decompress(&info); }
  Reader(const Reader&) = delete;

  jpeg_decompress_struct info{};
  Errors errors{};
  Source source{};
  jpeg_progress_mgr progress{};
};

// Calls libjpeg, which jumps out of `work` at an error: `work` must not own anything. @return whether there was none
template <class Work>
[[gnu::noinline]] bool succeeds(Errors& errors, const Work& work) {
  if (setjmp(errors.place)) return false;
  work();
  return true;
}

// One row of C, M, Y, K, inverted as Adobe's programs write them, as R, G, B.
void cmyk_to_rgb(const std::vector<uint8_t>& row, bool is_inverted, uint8_t* to) {
  for (size_t i = 0; i + 4 <= row.size(); i += 4, to += 3)
    for (size_t c = 0; c < 3; ++c) {
      const int ink = is_inverted ? row[i + c] : 255 - row[i + c], black = is_inverted ? row[i + 3] : 255 - row[i + 3];
      to[c] = uint8_t((ink * black + 127) / 255);
    }
}

// Long texts are in several comments.
void read_comment(const std::string& comment, PictureHeader& header) {
  const size_t blank = comment.find(' ');
  if (blank != std::string::npos) header.texts[comment.substr(0, blank)] += comment.substr(blank + 1);
}

}  // namespace

std::optional<Picture> read_jpeg(ByteSource& bytes, const HeaderCheck& wants) {
  Reader reader(bytes);
  jpeg_decompress_struct& info = reader.info;
  const bool has_header = succeeds(reader.errors, [&] {
    jpeg_create_decompress(&info);
    info.src = &reader.source;
    info.progress = &reader.progress;
    jpeg_save_markers(&info, JPEG_APP0 + 1, 0xffff);
    jpeg_save_markers(&info, JPEG_COM, 0xffff);
    jpeg_read_header(&info, TRUE);
  });
  if (!has_header) return std::nullopt;
  const bool is_cmyk = info.num_components == 4;
  if (is_cmyk)
    info.out_color_space = JCS_CMYK;  // also from YCCK
  else
    info.out_color_space = info.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  Picture picture;
  picture.columns = int(info.image_width);
  picture.rows = int(info.image_height);
  picture.channels = channels_named(info.num_components == 1 ? 1 : 3);
  for (const auto* marker = info.marker_list; marker; marker = marker->next)
    if (marker->marker == JPEG_COM)
      read_comment(std::string(marker->data, marker->data + marker->data_length), picture);
    else if (picture.orientation == 1)
      picture.orientation = exif_orientation(marker->data, marker->data_length);
  if (!wants(picture)) return picture;

  picture.samples = samples_for(picture);
  uint8_t* first = std::get<std::vector<uint8_t>>(picture.samples).data();
  const size_t row_size = size_t(picture.columns) * picture.channels.size();
  std::vector<uint8_t> inks(is_cmyk ? size_t(picture.columns) * 4 : 0);
  picture.is_complete = succeeds(reader.errors, [&] {
    jpeg_start_decompress(&info);
    while (info.output_scanline < info.output_height) {
      uint8_t* to = first + size_t(info.output_scanline) * row_size;
      JSAMPROW row = is_cmyk ? inks.data() : to;
      jpeg_read_scanlines(&info, &row, 1);
      if (is_cmyk) cmyk_to_rgb(inks, info.saw_Adobe_marker, to);
    }
  });
  return picture;
}

namespace {

struct Target : jpeg_destination_mgr {
  NewFile* file = nullptr;
  std::array<JOCTET, 1 << 14> buffer;
};

void start_buffer(j_compress_ptr info) {
  auto& target = *static_cast<Target*>(info->dest);
  target.next_output_byte = target.buffer.data();
  target.free_in_buffer = target.buffer.size();
}

boolean empty_buffer(j_compress_ptr info) {
  auto& target = *static_cast<Target*>(info->dest);
  target.file->put(target.buffer.data(), target.buffer.size());
  start_buffer(info);
  return TRUE;
}

void put_rest(j_compress_ptr info) {
  auto& target = *static_cast<Target*>(info->dest);
  target.file->put(target.buffer.data(), target.buffer.size() - target.free_in_buffer);
}

struct JpegWriter {
  JpegWriter() {
    info.err = jpeg_std_error(&errors);
    errors.error_exit = jump;
    errors.output_message = [](j_common_ptr) {};
    target.init_destination = start_buffer;
    target.empty_output_buffer = empty_buffer;
    target.term_destination = put_rest;
  }
  ~JpegWriter() { jpeg_destroy_compress(&info); }
  JpegWriter(const JpegWriter&) = delete;

  jpeg_compress_struct info{};
  Errors errors{};
  Target target{};
};

}  // namespace

void write_jpeg(const std::string& path, const JpegHeader& header, const uint8_t* samples) {
  constexpr int most = JPEG_MAX_DIMENSION, quality = 95;
  require(header.columns <= most && header.rows <= most,
          "{}: expected at most {} × {} pixels in a JPEG, got {} × {}; name a .png", path, most, most, header.columns,
          header.rows);
  std::vector<std::string> comments;
  constexpr size_t longest = 60000;  // bytes of a text in one comment, which holds 65533 with its name
  for (const auto& [name, text] : header.texts)
    for (size_t at = 0; at < text.size(); at += longest)
      comments.push_back(fmt::format("{} {}", name, text.substr(at, longest)));
  NewFile file(path);
  JpegWriter writer;
  jpeg_compress_struct& info = writer.info;
  writer.target.file = &file;
  const bool is_written = succeeds(writer.errors, [&] {
    jpeg_create_compress(&info);
    info.dest = &writer.target;
    info.image_width = JDIMENSION(header.columns);
    info.image_height = JDIMENSION(header.rows);
    info.input_components = header.channels;
    info.in_color_space = header.channels == 3 ? JCS_RGB : JCS_GRAYSCALE;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, quality, TRUE);
    info.optimize_coding = TRUE;
    info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;  // 4:4:4
    jpeg_start_compress(&info, TRUE);
    for (const std::string& comment : comments)
      jpeg_write_marker(&info, JPEG_COM, reinterpret_cast<const JOCTET*>(comment.data()), unsigned(comment.size()));
    while (info.next_scanline < info.image_height) {
      auto* row = const_cast<JSAMPROW>(  // only read
          samples + size_t(info.next_scanline) * size_t(header.columns) * size_t(header.channels));
      jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
  });
  file.check();
  require(is_written, "expected to write {} as a JPEG of {} × {} pixels, but it cannot hold them; use fewer pixels",
          path, header.columns, header.rows);
  file.finish();
}

}  // namespace holotrace
