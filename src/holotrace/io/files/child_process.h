#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Work in other processes: readers of damaged files, and programs of others.
//
// Some libraries end or hang the program at damaged files. Such a file is read in a child process with limits, which
// sends what it has read through a pipe. Whatever happens there, the program itself goes on and names the file.

namespace holotrace {

/// The child's end of the pipe.
class ToParent {
 public:
  explicit ToParent(int pipe) : pipe_(pipe) {}
  void bytes(const void* data, size_t size);
  template <class T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&value, sizeof value);
  }
  template <class T>
  void list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(uint64_t(values.size()));
    bytes(values.data(), values.size() * sizeof(T));
  }
  void text(std::string_view text);

  /// Raises the limits for work of a known size, after that size was checked.
  void allow(double seconds_of_processor, double bytes_of_memory);

 private:
  int pipe_;
};

/// The parent's end. Each function throws if the child ends before it has sent as much.
class FromChild {
 public:
  explicit FromChild(int pipe) : pipe_(pipe) {}
  void bytes(void* data, size_t size);
  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    bytes(&value, sizeof value);
    return value;
  }
  template <class T>
  std::vector<T> list() {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(size(sizeof(T)));
    bytes(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string text();

 private:
  size_t size(size_t bytes_of_item);
  int pipe_;
};

/// Runs `read` in a child process and `receive` here at the same time. The child has 2 s of processor time and 1 GiB
/// of memory beyond what the program has when it starts, unless it calls ToParent::allow; it does not print.
/// @param path  file that is read, for messages
/// @throws Error  that of `read` or `receive`; and, naming the file, if the child crashes or reaches a limit
///
/// Cost: a fork, about 1 ms and 1 ms more per GiB of the program's memory, and one copy of what is sent.
void read_in_child(const std::string& path, const std::function<void(ToParent&)>& read,
                   const std::function<void(FromChild&)>& receive);

/// What a program left that has run as a separate process.
struct ProgramRun {
  std::string start_error;       ///< the system's reason why it did not start; empty if it started
  bool has_succeeded = false;    ///< whether its exit code was 0
  std::string output, messages;  ///< its standard output and its standard error
};

/// Runs a program, which is found by PATH, and waits for its end. No shell is involved.
/// @param words  its name and its arguments
/// @param input  asked for the next bytes of its standard input, until there are none; they stay valid until it is asked
///               again
ProgramRun run_program(std::vector<std::string> words, const std::function<std::string_view()>& input);

}  // namespace holotrace
