#include "try_save_chart.h"

#include "console.h"
#include "holotrace/base/error.h"
#include "holotrace/io/picture/chart_file.h"

namespace holotrace {

void try_save_chart(const std::string& path, const Chart& chart, Console& console) {
  try {
    save_chart(path, chart);
  } catch (const Error& error) {
    console.watch("chart").warn(error.what());
    console.finish();
  }
}

}  // namespace holotrace
