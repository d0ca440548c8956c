#include "checkpoints.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <utility>

#include "holotrace/io/field/checkpoint_file.h"
#include "holotrace/io/files/output.h"

namespace holotrace {
namespace {

volatile std::sig_atomic_t is_interrupted = 0;

// Ctrl-C sets is_interrupted, once; a second one ends the program at once. After this object the action of before is back.
class Interrupts {
 public:
  Interrupts() {
    struct sigaction action {};
    action.sa_handler = [](int) { is_interrupted = 1; };
    action.sa_flags = int(SA_RESETHAND);
    sigaction(SIGINT, &action, &before_);
  }
  ~Interrupts() { sigaction(SIGINT, &before_, nullptr); }
  Interrupts(const Interrupts&) = delete;

 private:
  struct sigaction before_ {};
};

}  // namespace

bool was_interrupted() { return is_interrupted != 0; }

void Checkpoints::add_flag(CLI::App& command, std::string& path) {
  command
      .add_option(
          "--checkpoint", path,
          "sgd: file for the state of the iterations, saved once a minute and on Ctrl-C. The same command resumes "
          "from it and gives the same holograms. The file is removed at the end. Several colours: NAME, NAME_2, …")
      ->type_name("FILE.h5");
}

Checkpoints::Checkpoints(std::string path) : path_(std::move(path)) {
  if (are_kept()) check_output(path_, {".h5"});
}

Checkpoint Checkpoints::of(size_t i) const {
  if (!are_kept()) return {};
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds between_saves(60);
  const std::string path = numbered_path(path_, i);
  const auto interrupts = std::make_shared<Interrupts>();
  const auto saved = std::make_shared<Clock::time_point>(Clock::now());
  return {.load =
              [path, used = used_](const IterationState& job) {
                auto state = load_checkpoint(path, job);
                if (state) used->insert(path);
                return state;
              },
          .save =
              [path, saved, used = used_](const IterationState& state) {
                save_checkpoint(path, state);
                used->insert(path);
                *saved = Clock::now();
              },
          .is_due = [saved, between_saves] { return Clock::now() - *saved > between_saves; },
          .is_stopping = [interrupts] { return is_interrupted != 0; }};
}

void Checkpoints::remove() const {
  std::error_code ignored;  // another program may have removed one
  for (const std::string& path : *used_) std::filesystem::remove(path, ignored);
}

}  // namespace holotrace
