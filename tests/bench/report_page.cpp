#include "tests/bench/report_page.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "shared/base/text.h"
#include "tests/bench/papers.h"
#include "tests/bench/report.h"
#include "tests/bench/report_assets.h"
#include "tests/bench/report_experiments.h"
#include "tests/bench/tradeoff_front.h"

namespace macula::bench {
namespace {

namespace fs = std::filesystem;
using base::forward;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// As a table shows it: what could not be measured is a dash.
std::string cell_text(const Value& value) {
  const auto* number = std::get_if<double>(&value);
  return number != nullptr && !std::isfinite(*number) ? "\u2013" : value_text(value);
}

/// JSON in a page must not end its own script: "</" becomes "<\\/", which is the same text.
std::string as_script(const std::string& id, const std::string& json) {
  std::string safe;
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (json[i] == '/' && i > 0 && json[i - 1] == '<') safe += '\\';
    safe += json[i];
  }
  return base::concat("<script type=\"application/json\" id=\"", id, "\">", safe, "</script>\n");
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
    };
    const unsigned three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string table_html(const std::vector<Fields>& rows, const std::set<std::string>& hidden = {}) {
  if (rows.empty()) return {};
  const auto is_text = [](const Value& value) {
    return std::holds_alternative<std::string>(value);
  };
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (const auto& [key, value] : rows.front())
    if (!hidden.contains(key))
      html += base::concat("<th", is_text(value) ? " class=\"t\"" : "", ">", escaped(key), "</th>");
  html += "</tr></thead><tbody>\n";
  for (const Fields& row : rows) {
    const bool front = std::ranges::any_of(row, [](const auto& field) {
      const bool* yes = std::get_if<bool>(&field.second);
      return field.first == "on_front" && yes != nullptr && *yes;
    });
    html += front ? "<tr class=\"front\">" : "<tr>";
    for (const auto& [key, value] : row)
      if (!hidden.contains(key))
        html += base::concat("<td", is_text(value) ? " class=\"t\"" : "", ">",
                             escaped(cell_text(value)), "</td>");
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string facts_html(const Fields& facts) {
  std::string html = "<div class=\"facts\">";
  for (const auto& [key, value] : facts) {
    const std::string text = value_text(value);
    if (!text.empty())
      html += base::concat("<span>", escaped(key), " <b>", escaped(text), "</b></span>");
  }
  return html + "</div>\n";
}

/// What the papers say of the experiment's kernel.
std::vector<Fields> papers_of(const std::string& kernel) {
  std::vector<Fields> rows;
  for (const PaperPoint& point : paper_points())
    if (point.kernel == kernel)
      rows.push_back({{"paper", std::string(point.paper)},
                      {"place", std::string(point.place)},
                      {"setting", std::string(point.setting)},
                      {"quantity", std::string(point.quantity)},
                      {"value", point.value}});
  return rows;
}

std::string papers_html(const std::string& kernel) {
  const auto rows = papers_of(kernel);
  if (rows.empty()) return {};
  return base::concat(
      "<h3>What the paper reports</h3>\n<p class=\"lead\">Milliseconds are those of its own "
      "graphics card; factors and errors carry over.</p>\n",
      table_html(rows));
}

/// One report on its way into the page.
class Section {
 public:
  Section(const LoadedReport& report, std::string id, fs::path folder)
      : report_(report), id_(std::move(id)), folder_(std::move(folder)) {}

  std::string html() const {
    std::string html =
        base::concat("<section id=\"", id_, "\">\n<h2>", escaped(report_.experiment), "</h2>\n",
                     facts_html(report_.machine),
                     facts_html({{"commit", report_.commit},
                                 {"rows", static_cast<std::int64_t>(report_.rows.size())}}));
    if (!view_.lead.empty())
      html += base::concat("<p class=\"lead\">", escaped(std::string(view_.lead)), "</p>\n");
    if (!report_.command.empty())
      html += base::concat("<pre>", escaped(report_.command), "</pre>\n");
    html += base::concat("<details><summary>Settings</summary>", facts_html(report_.config),
                         "</details>\n");
    html += report_.experiment == "tradeoff" ? tradeoff() : plain();
    return html + "</section>\n";
  }

 private:
  std::string plain() const {
    if (report_.rows.empty()) return "<p>No rows.</p>\n";
    return as_script(id_ + "-rows", rows_json(report_.rows)) +
           charts(id_, holds("scene") ? "scene" : "") + table_html(report_.rows) +
           papers_html(report_.experiment);
  }

  bool holds(std::string_view key) const {
    return std::ranges::any_of(report_.rows.front(),
                               [&](const auto& field) { return field.first == key; });
  }

  /// Of the rows in the script `id`-rows, one for each value of `by`.
  std::string charts(const std::string& id, std::string_view by) const {
    return base::concat("<div data-charts=\"", id, "-rows\" data-by=\"", by, "\" data-x=\"",
                        view_.x, "\" data-y=\"", view_.y, "\" data-series=\"", view_.series,
                        "\"></div>\n");
  }

  std::vector<Fields> rows_of(const std::string& key, const std::string& value,
                              const std::vector<Fields>& from) const {
    std::vector<Fields> some;
    for (const Fields& row : from)
      if (text_in(row, key) == value) some.push_back(row);
    return some;
  }

  static std::vector<std::string> values_of(const std::string& key,
                                            const std::vector<Fields>& rows) {
    std::vector<std::string> values;
    for (const Fields& row : rows)
      if (const std::string value = text_in(row, key);
          std::ranges::find(values, value) == values.end())
        values.push_back(value);
    return values;
  }

  std::string tradeoff() const {
    std::string html =
        "<div class=\"key\"><span><i style=\"border-color:var(--front)\"></i>"
        "foveated front</span><span><i style=\"border-color:var(--base)\"></i>whole pictures"
        "</span></div>\n";
    for (const std::string& kernel : values_of("kernel", report_.rows)) {
      const auto own = rows_of("kernel", kernel, report_.rows);
      const std::string id = base::concat(id_, "-", kernel);
      html += base::concat("<h3 id=\"", id, "\">Kernel ", escaped(kernel), "</h3>\n") +
              as_script(id + "-rows", rows_json(own)) + charts(id, "scene") + advantages(own) +
              wipes(own, id) + "<details><summary>All rows (bold: on the front)</summary>" +
              table_html(own, {"picture", "kernel", "uniform"}) + "</details>\n" +
              papers_html(kernel);
    }
    return html;
  }

  std::string advantages(const std::vector<Fields>& rows) const {
    std::vector<Fields> lines;
    for (const std::string& scene : values_of("scene", rows)) {
      const auto here = rows_of("scene", scene, rows);
      Fields line{{"scene", scene}};
      for (const auto& [key, name] : {std::pair{"rmse_f10", "RMSE in 10 deg"},
                                      std::pair{"rmse_ew", "RMSE as the eye weighs it"},
                                      std::pair{"flip_out10", "FLIP outside 10 deg"}}) {
        const Advantage a = foveated_advantage(here, key);
        char text[64];
        std::snprintf(text, sizeof text, "%.2f of %.2f decades", a.below_decades, a.of_decades);
        line.emplace_back(base::concat(name, ": better over"), std::string(text));
        line.emplace_back("uniform / foveated", a.mean_ratio);
      }
      line.emplace_back("scene hash", text_in(here.front(), "scene_hash"));
      lines.push_back(std::move(line));
    }
    return base::concat(
        "<p class=\"lead\">Where the foveated front lies below whole pictures of equal time, and "
        "by "
        "how much (geometric mean over time).</p>\n",
        table_html(lines));
  }

  /// The reference, and what lies on the front; a picture each.
  std::string wipes(const std::vector<Fields>& rows, const std::string& id) const {
    std::string html;
    for (const std::string& scene : values_of("scene", rows)) {
      std::string json;
      const auto add = [&](const std::string& name, const std::string& file) {
        const std::string bytes = picture(file);
        if (bytes.empty()) return;
        json +=
            base::concat(json.empty() ? "{" : ",", quoted_json(name), ":\"", base64(bytes), "\"");
      };
      const auto here = rows_of("scene", scene, rows);
      const std::string kernel = text_in(here.front(), "kernel");
      for (const Fields& row : here) {
        const bool front = value_text(value_in(row, "on_front")) == "yes";
        const std::string config = text_in(row, "config");
        if (front || config == "scale=1") add(config, text_in(row, "picture"));
      }
      if (json.empty()) continue;
      const std::string after = json;
      json.clear();
      add("reference", base::concat(kernel, "_", scene, "_reference.png"));
      json = json.empty() ? after : base::concat(json, ",", std::string_view(after).substr(1));
      html += base::concat("<figure><figcaption>", escaped(scene), "</figcaption>",
                           as_script(id + "-" + scene, json + "}"), "<div data-wipe=\"", id, "-",
                           escaped(scene), "\"></div></figure>\n");
    }
    return html.empty() ? html : base::concat("<div class=\"grid\">", html, "</div>\n");
  }

  /// Its bytes; from the folder that the report names, or beside the report.
  std::string picture(const std::string& file) const {
    if (file.empty()) return {};
    const std::string named = text_in(report_.config, "pictures");
    for (const fs::path& folder :
         {fs::path(named), folder_ / named, folder_ / "pictures", folder_}) {
      std::ifstream in(folder / file, std::ios::binary);
      if (in) return {std::istreambuf_iterator<char>(in), {}};
    }
    return {};
  }

  const LoadedReport& report_;
  const ExperimentView& view_ = experiment_view(report_.experiment);
  const std::string id_;
  const fs::path folder_;
};

Result<std::vector<fs::path>> list_files(const std::vector<std::string>& inputs) {
  std::vector<fs::path> files;
  for (const std::string& input : inputs) {
    std::error_code failed;
    if (!fs::is_directory(input, failed)) {
      files.emplace_back(input);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(input, failed))
      if (entry.path().extension() == ".json") inside.push_back(entry.path());
    if (inside.empty())
      return base::bad_input("holds no report", input, "a folder with .json files of experiments");
    std::ranges::sort(inside);
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

std::string page_of(const std::string& sections, const std::string& links) {
  std::ostringstream page;
  page << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<title>Macula: measurements</title>\n<style>"
       << kPageStyle << "</style></head>\n<body>\n<header><h1>Macula: measurements</h1>\n"
       << "<p class=\"lead\">Foveated rendering and streaming, measured: what each method costs, "
          "how "
          "far it is from the truth, and the exact commands that show it.</p></header>\n<nav>"
       << links << "</nav>\n<main>\n"
       << sections
       << "<footer>Made by <code>macula-bench report</code>. This page needs no other "
          "file.</footer>\n"
       << "</main>\n<script>" << kPageScript << "</script>\n</body></html>\n";
  return std::move(page).str();
}

}  // namespace

Result<void> run_report_page(const PageOptions& options) {
  const auto files = list_files(options.inputs);
  if (!files) return forward(files);
  std::vector<std::pair<LoadedReport, fs::path>> reports;  // and the folder of each
  for (const fs::path& file : *files) {
    auto report = read_report(file.string());
    if (!report) return forward(report);
    reports.emplace_back(std::move(*report), file.parent_path());
  }
  std::ranges::stable_sort(reports, {},
                           [](const auto& one) { return experiment_order(one.first.experiment); });
  std::string sections, links;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const auto& [report, folder] = reports[i];
    const std::string id = base::concat("r", i);
    sections += Section(report, id, folder).html();
    links += base::concat("<a href=\"#", id, "\">", escaped(report.experiment), "</a>");
  }
  errno = 0;
  std::ofstream out(options.out, std::ios::binary | std::ios::trunc);
  out << page_of(sections, links);
  out.close();
  if (!out)
    return base::bad_input(std::string("cannot be written: ") + std::strerror(errno), options.out,
                           "give a path in a folder that exists and has room");
  std::printf("%s\n", options.out.c_str());
  return {};
}

}  // namespace macula::bench
