#include "results/xdmf.hpp"

#include <fmt/format.h>

#include "results/store.hpp"

namespace clothbench {

void write_xdmf(const std::filesystem::path& path, const std::string& h5_name, const CellRecord& record) {
  const std::size_t triangles = record.header.triangles.size() / 3;
  std::string out =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n <Domain>\n"
      "  <Grid Name=\"cloth\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t k = 0; k < record.accuracy.time_s.size(); ++k)
    out += fmt::format(
        "   <Grid Name=\"frame {0}\" GridType=\"Uniform\">\n"
        "    <Time Value=\"{1:.9g}\"/>\n"
        "    <Topology TopologyType=\"Triangle\" NumberOfElements=\"{2}\">\n"
        "     <DataItem Dimensions=\"{2} 3\" NumberType=\"Int\" Precision=\"8\" Format=\"HDF\">{3}:/triangles</DataItem>\n"
        "    </Topology>\n"
        "    <Geometry GeometryType=\"XYZ\">\n"
        "     <DataItem Dimensions=\"{4} 3\" NumberType=\"Float\" Precision=\"4\" Format=\"HDF\">{3}:/frames/{0:06}</DataItem>\n"
        "    </Geometry>\n"
        "   </Grid>\n",
        k, record.accuracy.time_s[k], triangles, h5_name, record.header.vertices);
  out += "  </Grid>\n </Domain>\n</Xdmf>\n";
  write_file_atomically(path, out);
}

}  // namespace clothbench
