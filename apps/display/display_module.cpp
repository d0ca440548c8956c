// Pictures on a monitor by SDL: full-screen, a pixel of the panel on each pixel of the monitor, without scaling.

#include "display/display_module.h"

#include <SDL.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using holotrace::DisplayJob;
using holotrace::DisplayOutcome;

// Frees what SDL made, in the order of its making from behind.
struct Screen {
  SDL_Window* window = nullptr;
  SDL_Renderer* renderer = nullptr;
  std::vector<SDL_Texture*> pictures;

  ~Screen() {
    for (SDL_Texture* picture : pictures) SDL_DestroyTexture(picture);
    if (renderer) SDL_DestroyRenderer(renderer);
    if (window) SDL_DestroyWindow(window);
    SDL_Quit();
  }
};

// A virtual monitor has no refresh of its own.
double refresh_of(const SDL_DisplayMode& mode) { return mode.refresh_rate > 0 ? mode.refresh_rate : 60; }

std::string modes_text(int monitor) {
  std::string text;
  std::string last;
  for (int i = 0; i < SDL_GetNumDisplayModes(monitor); ++i) {
    SDL_DisplayMode mode;
    if (SDL_GetDisplayMode(monitor, i, &mode) != 0) continue;
    const std::string size = std::to_string(mode.w) + " x " + std::to_string(mode.h);
    if (size != last && text.size() < 200) text += (text.empty() ? "" : ", ") + size;
    last = size;
  }
  return text.empty() ? "none" : text;
}

// The mode of the monitor with exactly as many pixels as the panel, and a multiple of the rate as its own.
bool find_mode(const DisplayJob& job, SDL_DisplayMode& found) {
  const auto fits = [&](const SDL_DisplayMode& mode) {
    if (mode.w != job.columns || mode.h != job.rows) return false;
    const double ratio = job.rate > 0 ? refresh_of(mode) / job.rate : 1;
    return std::round(ratio) >= 1 && std::abs(ratio - std::round(ratio)) < 0.02;  // 59 and 59.94 Hz are both called 60
  };
  if (SDL_GetDesktopDisplayMode(job.monitor, &found) == 0 && fits(found)) return true;
  for (int i = 0; i < SDL_GetNumDisplayModes(job.monitor); ++i)
    if (SDL_GetDisplayMode(job.monitor, i, &found) == 0 && fits(found)) return true;
  return false;
}

// Makes the pictures of the screen those of the job. @return a problem, or ""
std::string load_pictures(const DisplayJob& job, Screen& screen) {
  for (size_t p = 0; p < size_t(job.pictures); ++p) {
    if (p == screen.pictures.size()) {
      SDL_Texture* picture =
          SDL_CreateTexture(screen.renderer, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STATIC, job.columns, job.rows);
      if (!picture) return SDL_GetError();
      screen.pictures.push_back(picture);
    }
    std::vector<uint32_t> pixels(size_t(job.columns) * size_t(job.rows));
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = 0xff000000u | job.colours[p][i];
    if (SDL_UpdateTexture(screen.pictures[p], nullptr, pixels.data(), job.columns * 4) != 0) return SDL_GetError();
  }
  for (; screen.pictures.size() > size_t(job.pictures); screen.pictures.pop_back())
    SDL_DestroyTexture(screen.pictures.back());
  return "";
}

std::string open_screen(const DisplayJob& job, const SDL_DisplayMode& mode, Screen& screen) {
  SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "nearest");
  SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
  SDL_Rect place;
  SDL_GetDisplayBounds(job.monitor, &place);
  SDL_DisplayMode desktop;
  const bool is_desktop = SDL_GetDesktopDisplayMode(job.monitor, &desktop) == 0 && desktop.w == mode.w &&
                          desktop.h == mode.h && desktop.refresh_rate == mode.refresh_rate;
  screen.window = SDL_CreateWindow("Holotrace", place.x, place.y, job.columns, job.rows,
                                   SDL_WINDOW_BORDERLESS | SDL_WINDOW_ALLOW_HIGHDPI | SDL_WINDOW_HIDDEN);
  if (!screen.window) return SDL_GetError();
  // Without the whole screen, the panel would show the hologram beside its place.
  if (SDL_SetWindowDisplayMode(screen.window, &mode) != 0 ||
      SDL_SetWindowFullscreen(screen.window, is_desktop ? SDL_WINDOW_FULLSCREEN_DESKTOP : SDL_WINDOW_FULLSCREEN) != 0)
    return SDL_GetError();
  SDL_ShowWindow(screen.window);
  screen.renderer = SDL_CreateRenderer(screen.window, -1, SDL_RENDERER_PRESENTVSYNC);
  if (!screen.renderer) return SDL_GetError();
  SDL_ShowCursor(SDL_DISABLE);
  SDL_DisableScreenSaver();
  return load_pictures(job, screen);
}
// Handles the events that are there. @return whether the user wants to end
bool is_ended_by_user() {
  SDL_Event event;
  bool is_ended = false;
  while (SDL_PollEvent(&event))
    is_ended = is_ended || event.type == SDL_QUIT || event.type == SDL_MOUSEBUTTONDOWN ||
               (event.type == SDL_KEYDOWN && (event.key.keysym.sym == SDLK_ESCAPE || event.key.keysym.sym == SDLK_q));
  return is_ended;
}

void fail(DisplayOutcome& outcome, const std::string& sentence) {
  std::snprintf(outcome.problem, sizeof outcome.problem, "%s", sentence.c_str());
}

// Shows the pictures in turn. Each is presented as often as the monitor refreshes in its time.
void show(DisplayJob job, const SDL_DisplayMode& mode, Screen& screen, DisplayOutcome& outcome) {
  const double refresh = refresh_of(mode);
  const int repeats = job.rate > 0 ? std::max(1, int(std::lround(refresh / job.rate))) : 1;
  outcome.rate = refresh / repeats;
  const double ticks = double(SDL_GetPerformanceFrequency());
  const auto now = [&] { return double(SDL_GetPerformanceCounter()) / ticks; };
  const double start = now(), period = 1 / refresh;
  double last = start;
  size_t shown = screen.pictures.size();  // none yet
  for (long presented = 0; !is_ended_by_user() && !job.is_over(); ++presented) {
    if (job.seconds > 0 && now() - start >= job.seconds) break;
    if (job.renew && job.renew(job.context, &job)) {
      if (const std::string problem = load_pictures(job, screen); !problem.empty()) return fail(outcome, problem);
      shown = screen.pictures.size();  // none of these yet
    }
    const size_t picture = size_t(presented / repeats) % screen.pictures.size();
    SDL_RenderCopy(screen.renderer, screen.pictures[picture], nullptr, nullptr);
    SDL_RenderPresent(screen.renderer);
    double at = now();
    if (presented > 0 && at - last < 0.5 * period) {  // the driver does not wait for the monitor
      SDL_Delay(uint32_t((last + period - at) * 1000));
      at = now();
    }
    if (presented > 2) outcome.missed += std::max(0L, std::lround((at - last) / period) - 1);  // the first ones open it
    last = at;
    outcome.shown += picture != shown;
    shown = picture;
  }
}

}  // namespace

extern "C" void holotrace_display(const DisplayJob* job, DisplayOutcome* outcome) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY") && !std::getenv("SDL_VIDEODRIVER"))
    return fail(*outcome, "expected a desktop with a monitor, got a session without X11 and without Wayland");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C is the program's
  if (SDL_Init(SDL_INIT_VIDEO) != 0)
    return fail(*outcome, std::string("expected a desktop with a monitor, got \"") + SDL_GetError() + "\"");
  Screen screen;
  // Without a desktop SDL draws into memory.
  const std::string driver = SDL_GetCurrentVideoDriver();
  if (driver == "offscreen" || driver == "dummy" || driver == "evdev")
    return fail(*outcome, "expected a desktop with a monitor, got SDL's driver \"" + driver +
                              "\" without one; start the desktop, or set DISPLAY to the one that runs");
  const int monitors = SDL_GetNumVideoDisplays();
  if (job->monitor >= monitors)
    return fail(*outcome, "expected a monitor from 1 to " + std::to_string(monitors) + ", got " +
                              std::to_string(job->monitor + 1) + "; give another --monitor");
  SDL_DisplayMode mode;
  if (!find_mode(*job, mode)) {
    char rate[64] = "";
    if (job->rate > 0) std::snprintf(rate, sizeof rate, " and a multiple of %g Hz", job->rate);
    return fail(*outcome, "expected a mode of monitor " + std::to_string(job->monitor + 1) + " with the panel's " +
                              std::to_string(job->columns) + " x " + std::to_string(job->rows) + " pixels" + rate +
                              ", got only " + modes_text(job->monitor) +
                              "; pictures are never scaled: choose another monitor or rate");
  }
  const std::string problem = open_screen(*job, mode, screen);
  if (!problem.empty()) return fail(*outcome, "expected a full-screen window, got \"" + problem + "\"");
  int columns = 0, rows = 0;
  SDL_GetRendererOutputSize(screen.renderer, &columns, &rows);
  if (columns != job->columns || rows != job->rows)
    return fail(*outcome, "expected a window of " + std::to_string(job->columns) + " x " + std::to_string(job->rows) +
                              " pixels, got " + std::to_string(columns) + " x " + std::to_string(rows) +
                              "; turn off the scaling of the desktop on this monitor");
  show(*job, mode, screen, *outcome);
}
