// holotrace: from 3D scenes to holograms, and to what a viewer sees of them.

#include <tbb/global_control.h>

#include <exception>
#include <memory>
#include <new>

#include "commands.h"
#include "holotrace/base/error.h"
#include "holotrace/io/wisdom_file.h"

namespace {

int report_error(const std::string& sentence) {
  fmt::print(stderr, "holotrace: {}\n", sentence);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace holotrace;
  CLI::App app{"Holotrace turns 3D scenes into holograms and shows what a viewer would see of them."};
  app.set_version_flag("--version", std::string("holotrace ") + HOLOTRACE_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  app.get_formatter()->column_width(36);

  GlobalFlags global;
  app.add_option("--threads", global.threads, "threads to use; 0: all. The result does not depend on it")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("-q,--quiet", global.is_quiet, "no progress bars");

  std::unique_ptr<tbb::global_control> limit;
  app.parse_complete_callback([&] {
    if (global.threads > 0)
      limit =
          std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, size_t(global.threads));
  });
  add_scene_commands(app, global);
  add_hologram_commands(app, global);
  add_inspect_commands(app, global);
  add_bench_command(app, global);

  keep_fft_wisdom();
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::bad_alloc&) {
    return report_error(
        "expected enough memory for this job, ran out; use a smaller panel, fewer subpixels or fewer samples");
  } catch (const std::exception& error) {
    return report_error(error.what());
  }
}
