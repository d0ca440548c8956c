// holotrace: from 3D scenes to holograms, and to what a viewer sees of them.

#include <malloc.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "checkpoints.h"
#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/params/parameter_texts.h"
#include "holotrace/estimate/machine/calibrate.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/user_cache.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "interrupts.h"
#include "rank_links.h"
#include "ranks.h"

namespace {

constexpr const char* out_of_memory =
    "expected enough memory for this job, but it ran out; use smaller files, a smaller panel, fewer subpixels or fewer "
    "samples";

int report_error(const std::string& sentence) {
  holotrace::say("holotrace: {}\n", holotrace::printable(sentence));
  return 1;
}

// Checks --threads. CLI11's own check would print the largest double in its message.
std::string check_threads(const std::string& text) {
  const bool is_count = !text.empty() && text.size() < 7 && text.find_first_not_of("0123456789") == std::string::npos;
  return is_count ? "" : "expected a whole number of 0 or more, got \"" + text + "\"";
}

// Reports wrong usage.
int report_usage(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  holotrace::say("{}\nRun with --help for more information.\n",
                 holotrace::printable(holotrace::usage_message(app, error, argc, argv)));
  return 2;
}

// The exit code, once all that was printed has left the program: standard output may be a file on a full disk.
int after_output(int exit_code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return report_error(fmt::format("expected to write the standard output, got \"{}\"; make room where it goes",
                                  std::strerror(errno != 0 ? errno : EIO)));
}

// What the user's cache folder keeps between runs.
void use_kept_files() {
  using namespace holotrace;
  const auto warn = [](const std::string& sentence) { say("warning: {}\n", sentence); };
  set_summation_rates([warn] { return keep_summation_rates(calibration_key(), calibrate_summation, warn); });
  set_device_rates([warn](Device& device) {
    return keep_device_rates(
        device_calibration_key(device.info()), [&] { return calibrate_device(device); }, warn);
  });
  set_program_store({load_kept_program, keep_program, keep_compiler_log});
}

// Runs the command line. @throws what its command throws, but for wrong usage, which is reported. @return the exit code
int parse_and_run(int argc, char** argv, holotrace::Ranks& ranks) {
  using namespace holotrace;
  CLI::App app{"Holotrace turns 3D scenes into holograms and shows what a viewer sees.", "holotrace"};
  app.set_version_flag("--version", std::string("holotrace ") + HOLOTRACE_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  app.get_formatter()->column_width(36);

  GlobalFlags global{.ranks = &ranks};
  app.add_option("--threads", global.threads, "number of threads; 0: all. Results do not depend on it")
      ->check(check_threads, "")
      ->type_name("N");
  app.add_flag("-q,--quiet", global.is_quiet, "no progress bars, no summary");
  app.add_flag("--allow-outside", global.allow_outside,
               "models and HDF5 files may name files outside their own folder; give it for files that you trust");

  std::unique_ptr<tbb::global_control> limit;
  app.parse_complete_callback([&] {
    const int threads = global.threads > 0 ? global.threads : ranks.threads();
    if (threads > 0)
      limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, size_t(threads));
  });
  add_scene_commands(app, global);
  add_animate_command(app, global);
  add_field_command(app, global);
  add_encode_command(app, global);
  add_show_command(app, global);
  add_view_command(app, global);
  add_display_command(app, global);
  add_propagate_command(app, global);
  add_compare_command(app, global);
  add_limits_command(app, global);
  add_examples_command(app, global);
  add_info_command(app, global);
  add_estimate_command(app, global);
  add_calibrate_command(app, global);
  add_bench_command(app, global);

  app.footer(
      "Environment:\n  HOLOTRACE_INSTRUCTIONS=NAME  instruction set of the kernels, instead of the best one of this "
      "processor: AVX3 (AVX-512), AVX2 or SSE4, as `holotrace bench` names them");

  const CommandFiles files;
  try {
    std::vector<std::string> arguments = with_bare_flags(app, argc, argv);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(std::move(arguments));
    return 0;
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error, argc, argv);
  }
}

int run_command(int argc, char** argv, holotrace::Ranks& ranks) {
  using namespace holotrace;
  try {
    return parse_and_run(argc, argv, ranks);
  } catch (const std::bad_alloc&) {
    return report_error(out_of_memory);
  } catch (const std::length_error&) {  // of a vector that is longer than the addresses of this machine
    return report_error(out_of_memory);
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return 1;  // after_output says what is wrong with it
    const int exit_code = report_error(error.what());
    return was_interrupted() ? interrupted_exit_code : exit_code;
  }
}

}  // namespace

// What is not an Error is a mistake in the program: it ends it with its own message.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  using namespace holotrace;
  end_on_interrupt();
  mallopt(M_MMAP_THRESHOLD, 4 << 20);  // pictures that are no longer needed go back to the system
  std::signal(SIGXFSZ, SIG_IGN);       // writing beyond the limit on file sizes becomes an Error
  try {
    if (const char* instructions = std::getenv("HOLOTRACE_INSTRUCTIONS"))
      read_flag("HOLOTRACE_INSTRUCTIONS", [&] { force_instruction_set(instructions); });
    Ranks ranks(argc, argv);
    use_kept_files();
    if (ranks.rank() > 0) {
      serve_ranks(ranks, [&] { parse_and_run(argc, argv, ranks); });
      return 0;
    }
    const int exit_code = after_output(run_command(argc, argv, ranks));
    dismiss_ranks(ranks, exit_code);
    return exit_code;
  } catch (const Error& error) {
    return report_error(error.what());
  }
}
