#include "interrupts.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <exception>

namespace holotrace {
namespace {

std::atomic<const char*> said = "holotrace: interrupted; files of earlier calls are as they were\n";
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler reads it");

std::atomic<bool> is_deferred = false, is_pending = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler reads it");

void end(int) {
  if (is_deferred) {
    is_pending = true;
    return;
  }
  const char* sentence = said;
  if (isatty(STDERR_FILENO) && write(STDERR_FILENO, "\n", 1) < 0) _exit(interrupted_exit_code);  // after a progress bar
  if (write(STDERR_FILENO, sentence, std::strlen(sentence)) < 0) _exit(interrupted_exit_code);
  _exit(interrupted_exit_code);
}

}  // namespace

void ignore_interrupts() {
  struct sigaction action {};
  action.sa_handler = SIG_IGN;
  sigaction(SIGINT, &action, nullptr);
}

void end_on_interrupt() {
  struct sigaction before {};
  if (sigaction(SIGINT, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) return;  // nohup, or a shell's "&"
  struct sigaction action {};
  action.sa_handler = end;
  sigaction(SIGINT, &action, nullptr);
}

DeferInterrupts::DeferInterrupts() { is_deferred = true; }

DeferInterrupts::~DeferInterrupts() {
  is_deferred = false;
  if (is_pending && std::uncaught_exceptions() == 0) end(SIGINT);
}

void say_on_interrupt(const char* sentence) { said = sentence; }

}  // namespace holotrace
