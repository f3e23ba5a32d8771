// A strict reader of HTML: what a browser would mend is an error here.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace burnish::testing {

/// Reads a page and says what is wrong with it: tags that are not closed or not nested, attributes
/// without quotes or given twice, a bare & or <. Elements and texts are kept for further checks.
class HtmlReader {
  public:
    struct Element {
        std::string name;
        std::vector<std::pair<std::string, std::string>> attributes;
    };
    std::vector<std::string> errors;
    std::vector<Element> elements;
    std::string text;  ///< between tags

    explicit HtmlReader(const std::string& page) : page_(page) {
        if (!page_.starts_with("<!DOCTYPE html>")) fail("the doctype is missing");
        at_ = page_.find('>') + 1;
        while (at_ < page_.size()) {
            if (page_[at_] == '<')
                read_tag();
            else
                read_text();
        }
        for (const std::string& name : open_) fail("<" + name + "> is not closed");
    }

    std::size_t count(const std::string& name) const {
        return static_cast<std::size_t>(std::count_if(
            elements.begin(), elements.end(), [&](const Element& e) { return e.name == name; }));
    }

  private:
    void fail(const std::string& what) { errors.push_back(what + " at " + std::to_string(at_)); }
    bool is_name(char c) const {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == ':';
    }
    std::string read_name() {
        std::string name;
        while (at_ < page_.size() && is_name(page_[at_])) name += page_[at_++];
        if (name.empty()) fail("a name is missing"), ++at_;
        return name;
    }
    void skip_space() {
        while (at_ < page_.size() && std::isspace(static_cast<unsigned char>(page_[at_]))) ++at_;
    }

    void check_entity(const std::string& in, std::size_t i) {
        const std::size_t end = in.find(';', i);
        const bool named =
            end != std::string::npos && end > i + 1 &&
            std::all_of(in.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                        in.begin() + static_cast<std::ptrdiff_t>(end), [](char c) {
                            return c == '#' || std::isalnum(static_cast<unsigned char>(c));
                        });
        if (!named) fail("a bare &");
    }
    void check_text(const std::string& t) {
        for (std::size_t i = 0; i < t.size(); ++i)
            if (t[i] == '&') check_entity(t, i);
    }

    void read_text() {
        const std::size_t end = std::min(page_.find('<', at_), page_.size());
        const std::string part = page_.substr(at_, end - at_);
        const bool raw = !open_.empty() && open_.back() == "style";
        if (!raw) check_text(part);
        if (part.find('>') != std::string::npos && !raw) fail("a bare >");
        text += part;
        at_ = end;
    }

    void read_end_tag() {
        ++at_;
        const std::string name = read_name();
        skip_space();
        if (at_ >= page_.size() || page_[at_] != '>') fail("</" + name + " does not end");
        ++at_;
        if (open_.empty() || open_.back() != name)
            fail("</" + name + "> closes " +
                 (open_.empty() ? "nothing" : "<" + open_.back() + ">"));
        else
            open_.pop_back();
    }

    void read_attribute(Element& element) {
        const std::string name = read_name();
        for (const auto& [known, value] : element.attributes)
            if (known == name) fail("the attribute " + name + " comes twice");
        std::string value;
        if (at_ < page_.size() && page_[at_] == '=') {
            ++at_;
            if (at_ >= page_.size() || page_[at_] != '"') return fail("a value without quotes");
            const std::size_t end = page_.find('"', ++at_);
            if (end == std::string::npos) return fail("a value without an end");
            value = page_.substr(at_, end - at_);
            check_text(value);
            if (value.find('<') != std::string::npos) fail("a < in a value");
            at_ = end + 1;
        }
        element.attributes.emplace_back(name, value);
    }

    void read_tag() {
        ++at_;
        if (at_ < page_.size() && page_[at_] == '/') return read_end_tag();
        Element element{read_name(), {}};
        bool closed = false;
        for (skip_space(); at_ < page_.size() && page_[at_] != '>'; skip_space()) {
            if (page_[at_] == '/')
                closed = true, ++at_;
            else
                read_attribute(element);
        }
        ++at_;
        const char* kVoid[] = {"meta", "img", "br", "hr", "link", "input"};
        const bool is_void =
            std::find(std::begin(kVoid), std::end(kVoid), element.name) != std::end(kVoid);
        if (!closed && !is_void) open_.push_back(element.name);
        elements.push_back(std::move(element));
    }

    const std::string page_;
    std::size_t at_ = 0;
    std::vector<std::string> open_;
};

}  // namespace burnish::testing
