#pragma once

namespace holotrace {

/// Exit code of a program that Ctrl-C ended: 128 and the number of the signal, as shells have it.
constexpr int interrupted_exit_code = 130;

/// From here on Ctrl-C has no effect on this process.
void ignore_interrupts();

/// From here on Ctrl-C (SIGINT) ends the program with a sentence that says what is kept, and interrupted_exit_code. Files
/// are written whole or not at all, so earlier ones stay as they were. In the 10 ms before main, while the system loads
/// the libraries, Ctrl-C ends the program by the signal itself, without a sentence: nothing has been done then.
void end_on_interrupt();

/// What Ctrl-C says from here on.
/// @param sentence  a literal
void say_on_interrupt(const char* sentence);

/// While such an object exists, an interrupt waits for its end: files are being given their names.
class DeferInterrupts {
 public:
  DeferInterrupts();
  ~DeferInterrupts();  ///< ends the program if an interrupt came; not where an error ends it, with its own sentence
  DeferInterrupts(const DeferInterrupts&) = delete;
  DeferInterrupts& operator=(const DeferInterrupts&) = delete;
};

}  // namespace holotrace
