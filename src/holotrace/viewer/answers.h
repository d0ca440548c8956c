#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>

#include "holotrace/base/own_threads.h"
#include "holotrace/viewer/http.h"
#include "holotrace/viewer/session.h"

namespace holotrace {

/// What the server answers. Paths after "/TOKEN/":
///
/// - ""            the page; and its files by their names
/// - session       Session::describe, after reading files again that have changed
/// - view          the picture of a state (requests.h): the length of a JSON text as 4 bytes (the lowest first), the text
///                 {columns, rows, channels, white, pitch_m, step, warnings, made_of, seconds}, and the values, 1 or 3 bytes for a pixel
/// - reference     the render that belongs to it, in the same form; for a scene it is traced
/// - improve       finds optimised holograms of a live scene; {is_improved, seconds}
/// - panel?item=&as=level|amplitude|phase   a hologram, in the same form
/// - metrics, values?column=&row=&columns=&rows=, command, report   JSON
/// - points        places of the scene as floats
/// - view.png, view.exr   the file that `holotrace show` writes
///
/// With `page` (a name) and `number`, a view, a reference or optimised holograms are given up (204) once the page has asked with a higher number. An error is
/// 400 with {"error": sentence}.
///
/// Pictures are computed in one thread that lasts, and renders in another one, so that views are answered meanwhile.
class Answers {
 public:
  Answers(Session& session, Access access) : session_(session), access_(std::move(access)) {}

  HttpAnswer operator()(const HttpRequest& request);

  /// Seconds since somebody last looked; the page's own questions for news do not count.
  double idle_seconds() const;

 private:
  HttpAnswer route(const std::string& path, const Query& query);
  struct Turn {
    std::string page;
    int64_t number = -1;  // none
  };
  static Turn take_turn(Query& query);
  bool is_outdated(const Turn& turn);
  HttpAnswer view(const Query& query, const Turn& turn);
  HttpAnswer reference(const Query& query, const Turn& turn);
  HttpAnswer improve(const Query& query, const Turn& turn);
  HttpAnswer film(const std::string& path, Query query);
  HttpAnswer panel(Query query);
  HttpAnswer values(Query query);

  Session& session_;
  const Access access_;
  std::mutex mutex_;
  std::map<std::string, int64_t> newest_;  // number of each page
  LastingThread pictures_, renders_;
  std::atomic<std::chrono::steady_clock::rep> last_use_ = std::chrono::steady_clock::now().time_since_epoch().count();
};

}  // namespace holotrace
