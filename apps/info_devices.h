#pragma once

namespace holotrace {

/// Prints the processor and the OpenCL devices of this machine, by the names that --device takes; or as JSON.
void print_devices(bool is_json);

}  // namespace holotrace
