#include "interrupts.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

namespace holotrace {
namespace {

std::atomic<const char*> said = "holotrace: interrupted; files of earlier calls are as they were\n";
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler reads it");

void end(int) {
  const char* sentence = said;
  if (isatty(STDERR_FILENO) && write(STDERR_FILENO, "\n", 1) < 0) _exit(interrupted_exit_code);  // after a progress bar
  if (write(STDERR_FILENO, sentence, std::strlen(sentence)) < 0) _exit(interrupted_exit_code);
  _exit(interrupted_exit_code);
}

}  // namespace

void end_on_interrupt() {
  struct sigaction before {};
  if (sigaction(SIGINT, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) return;  // nohup, or a shell's "&"
  struct sigaction action {};
  action.sa_handler = end;
  sigaction(SIGINT, &action, nullptr);
}

void say_on_interrupt(const char* sentence) { said = sentence; }

}  // namespace holotrace
