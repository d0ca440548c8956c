#include "holotrace/viewer/answers.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstring>
#include <new>
#include <stdexcept>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/viewer/json_text.h"
#include "holotrace/viewer/page_files.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr const char *json_type = "application/json", *bytes_type = "application/octet-stream";

HttpAnswer json_answer(const Json& json, int status = 200) { return {status, json_type, text_of(json)}; }

HttpAnswer error_answer(const std::string& sentence) { return json_answer({{"error", sentence}}, 400); }

HttpAnswer picture_answer(const BytePicture& picture, Json facts) {
  facts["columns"] = picture.nx;
  facts["rows"] = picture.ny;
  facts["channels"] = picture.channels;
  const std::string text = text_of(facts);
  HttpAnswer answer{200, bytes_type, {}};
  answer.body.reserve(4 + text.size() + picture.values.size());
  for (int byte = 0; byte < 4; ++byte) answer.body += char(text.size() >> (8 * byte) & 255);
  answer.body += text;
  answer.body.append(reinterpret_cast<const char*>(picture.values.data()), picture.values.size());
  return answer;
}

HttpAnswer view_answer(const TakenView& view, double seconds) {
  const Image& image = view.image;
  return picture_answer({image.nx, image.ny, image.channels, srgb_codes(image, view.white)},
                        {{"white", view.white},
                         {"pitch_m", image.pitch},
                         {"step", view.step},
                         {"warnings", view.warnings},
                         {"made_of", view.made_of},
                         {"seconds", seconds}});
}

// Takes a whole number out of a query.
int64_t take_number(Query& query, const std::string& key) {
  const auto found = query.find(key);
  require(found != query.end(), "expected a whole number for \"{}\", got none", key);
  const std::string text = found->second;
  query.erase(found);
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  require(error == std::errc() && end == text.data() + text.size() && value >= 0 && value < 1'000'000'000'000,
          "expected a whole number of 0 or more for \"{}\"", key);
  return value;
}

std::string take_text(Query& query, const std::string& key) {
  const auto found = query.find(key);
  if (found == query.end()) return "";
  std::string text = found->second;
  query.erase(found);
  return text;
}

}  // namespace

double Answers::idle_seconds() const {
  return std::chrono::duration<double>(Clock::now() - Clock::time_point(Clock::duration(last_use_))).count();
}

HttpAnswer Answers::operator()(const HttpRequest& request) {
  if (const std::string why = access_.refusal(request); !why.empty())
    return {403, "text/plain; charset=utf-8", why + "\n"};
  if (request.method != "GET" && request.method != "HEAD") return {405, "text/plain; charset=utf-8", "expected GET\n"};
  const std::string path = access_.inner_path(request);
  if (path != "session") last_use_ = Clock::now().time_since_epoch().count();
  const std::string name = path.empty() ? "index.html" : path;
  const auto file =
      std::find_if(page_files().begin(), page_files().end(), [&](const PageFile& f) { return f.name == name; });
  if (file != page_files().end())
    return {200, std::string(file->type), std::string(file->content), {}, access_.allows_frames};
  try {
    Query query = parse_query(request.query);
    const bool has_turn = path == "view" || path == "reference" || path == "improve";
    const Turn turn = has_turn ? take_turn(query) : Turn();
    if (is_outdated(turn)) return {204, {}, {}};  // tells a request that is at work that this one is newer
    HttpAnswer answer;
    LastingThread& thread = path == "reference" || path == "improve" || path.starts_with("film.")
                                ? renders_
                                : pictures_;  // they take seconds
    thread.call([&] {
      answer = path == "view"        ? view(query, turn)
               : path == "reference" ? reference(query, turn)
               : path == "improve"   ? improve(query, turn)
                                     : route(path, query);
    });
    return answer;
  } catch (const Error& error) {
    return error_answer(error.what());
  } catch (const std::bad_alloc&) {
    return error_answer(
        "expected enough memory for this view, but it ran out; use fewer subpixels or a smaller sensor");
  } catch (const std::length_error&) {
    return error_answer(
        "expected enough memory for this view, but it ran out; use fewer subpixels or a smaller sensor");
  }
}

HttpAnswer Answers::route(const std::string& path, const Query& query) {
  if (path == "session") {
    session_.refresh();
    return {200, json_type, session_.describe()};
  }
  if (path == "panel") return panel(query);
  if (path == "values") return values(query);
  if (path == "metrics") return {200, json_type, session_.metrics(session_.state_of(query))};
  if (path == "command") return json_answer({{"command", session_.command_line(query)}});
  if (path == "report") return {200, json_type, session_.report()};
  if (path == "points") {
    const std::vector<float> points = session_.points();
    std::string bytes(points.size() * sizeof(float), '\0');
    std::memcpy(bytes.data(), points.data(), bytes.size());
    return {200, bytes_type, bytes};
  }
  if (path.starts_with("film.")) return film(path, query);
  if (path == "view.png" || path == "view.exr")
    return {200, path == "view.png" ? "image/png" : "image/x-exr",
            session_.file(session_.state_of(query), path.substr(path.size() - 4)), path};
  return {404, "text/plain; charset=utf-8", "there is nothing of this name\n"};
}

Answers::Turn Answers::take_turn(Query& query) {
  Turn turn;
  if (query.count("number") > 0) turn.number = take_number(query, "number");
  turn.page = take_text(query, "page").substr(0, 32);
  return turn;
}

bool Answers::is_outdated(const Turn& turn) {
  if (turn.number < 0) return false;
  const std::lock_guard lock(mutex_);
  constexpr size_t most_pages = 64;
  if (newest_.size() >= most_pages && newest_.count(turn.page) == 0) newest_.clear();
  int64_t& newest = newest_[turn.page];
  newest = std::max(newest, turn.number);
  return turn.number < newest;
}

HttpAnswer Answers::view(const Query& query, const Turn& turn) {
  const auto start = Clock::now();
  const std::optional<TakenView> view = session_.view(session_.state_of(query), [&] { return is_outdated(turn); });
  if (!view) return {204, {}, {}};
  return view_answer(*view, std::chrono::duration<double>(Clock::now() - start).count());
}

HttpAnswer Answers::reference(const Query& query, const Turn& turn) {
  const auto start = Clock::now();
  if (!session_.has_render()) return json_answer({{"error", "there is no render beside these holograms"}}, 404);
  const auto render = session_.reference(session_.state_of(query), [&] { return is_outdated(turn); });
  if (!render) return {204, {}, {}};
  return view_answer(*render, std::chrono::duration<double>(Clock::now() - start).count());
}

HttpAnswer Answers::improve(const Query& query, const Turn& turn) {
  const auto start = Clock::now();
  const bool is_improved = session_.improve(session_.state_of(query), [&] { return is_outdated(turn); });
  return json_answer(
      {{"is_improved", is_improved}, {"seconds", std::chrono::duration<double>(Clock::now() - start).count()}});
}

HttpAnswer Answers::film(const std::string& path, Query query) {
  const std::string ending = path.substr(4), sweep = take_text(query, "sweep");
  require(std::find(animation_endings.begin(), animation_endings.end(), ending) != animation_endings.end(),
          "expected a film .gif, .webp, .mp4 or .webm, got {}", ending);
  require(sweep == "focus" || sweep == "parallax", "expected focus or parallax for \"sweep\"");
  const double from = parse_length(take_text(query, "sweep-from")), to = parse_length(take_text(query, "sweep-to"));
  const bool is_picture = ending == ".gif" || ending == ".webp";
  return {200, (is_picture ? "image/" : "video/") + ending.substr(1),
          session_.film(session_.state_of(query), sweep == "focus" ? Sweep::focus : Sweep::parallax, from, to, ending),
          path};
}

HttpAnswer Answers::panel(Query query) {
  const size_t item = size_t(take_number(query, "item"));
  const std::string as = take_text(query, "as");
  require(as == "level" || as == "amplitude" || as == "phase", "expected level, amplitude or phase for \"as\"");
  const PanelQuantity quantity = as == "level"       ? PanelQuantity::level
                                 : as == "amplitude" ? PanelQuantity::amplitude
                                                     : PanelQuantity::phase;
  return picture_answer(session_.panel(item, quantity, session_.state_of(query)), Json::object());
}

HttpAnswer Answers::values(Query query) {
  int window[4];
  const char* const keys[] = {"column", "row", "columns", "rows"};
  for (size_t i = 0; i < 4; ++i) window[i] = int(std::min<int64_t>(take_number(query, keys[i]), 1 << 30));
  return {200, json_type, session_.values(session_.state_of(query), window[0], window[1], window[2], window[3])};
}

}  // namespace holotrace
