#include "end_to_end/faults.h"

#include <sstream>

#include "holotrace/base/sanitizers.h"

namespace holotrace::test {

bool has_strace(const Workplace& work) {
#if HOLOTRACE_THREAD_SANITIZER
  return false;  // this sanitizer writes a file when it starts, and lives without it: not a fault of the program
#endif
  return work.run_under({"strace", "-qq", "-e", "trace=none"}, {"--version"}).exit_code == 0;
}

FaultyRun run_with(const Workplace& work, const Fault& fault, const std::vector<std::string>& arguments) {
  const std::string inject = "inject=" + fault.calls + ":" + fault.effect + ":when=" + std::to_string(fault.at);
  // The leak check of the address sanitizer does not work under strace. -y names the file of each call.
  FaultyRun run{work.run_under({"env", "ASAN_OPTIONS=detect_leaks=0", "strace", "-f", "-qq", "-y", "-o", "calls.txt",
                                "-e", "trace=" + fault.calls, "-e", "signal=none", "-e", inject},
                               arguments),
                ""};
  std::istringstream calls(work.read("calls.txt"));
  for (std::string line; run.call.empty() && std::getline(calls, line);)
    if (line.find("(INJECTED)") != std::string::npos) run.call = line;
  std::filesystem::remove(work.path("calls.txt"));
  return run;
}

}  // namespace holotrace::test
