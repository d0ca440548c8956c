#pragma once

#include <string>

namespace holotrace {

/// The place of a process among those of a job that run on the same machine.
struct PlaceOnMachine {
  int number = 0, count = 1;
};

/// Messages between the processes 0 … count − 1 of a job. The program sends them, by MPI. Messages from one process to
/// another arrive in their order. Only one thread of each process may use them.
class ProcessLinks {
 public:
  virtual ~ProcessLinks() = default;

  virtual int count() const = 0;
  virtual PlaceOnMachine here() const = 0;

  /// When it returns, the bytes may be reused. Up to 2 GiB.
  virtual void send(int to, const std::string& bytes) = 0;

  /// Waits for the next message of that process. @throws Error  what it says, if that process has failed
  virtual std::string receive(int from) = 0;
};

}  // namespace holotrace
