// Words of the page, from one file for each language.

const LANGUAGES = { en: "English", zh: "中文" };
let words = {};
let fallback = {};

export let language = localStorage.getItem("language")
  || (navigator.language.startsWith("zh") ? "zh" : "en");

async function read(name) {
  return (await fetch(`/page/texts.${name}.json`)).json();
}

export async function load() {
  [words, fallback] = await Promise.all([read(language), read("en")]);
  document.documentElement.lang = language;
}

export async function change() {
  language = language === "en" ? "zh" : "en";
  localStorage.setItem("language", language);
  await load();
}

export const other = () => LANGUAGES[language === "en" ? "zh" : "en"];

// {0}, {1} stand for what is given besides. What the cell has not said is a dash, as a word ("state_")
// and as a value.
export function t(key, ...values) {
  const text = words[key] ?? fallback[key] ?? (key.endsWith("_") ? "—" : key);
  return values.reduce((done, value, i) => done.replaceAll(`{${i}}`, value ?? "—"), text);
}

// What the daemon said in English, unless the language has words of its own for its number.
export const given = (key, english) => words[key] ?? (english || (fallback[key] ?? "—"));

export const colon = () => (language === "zh" ? "：" : ": ");

// "F207 Data from a device is too old: facts" in this language, also where one fault is told in the
// facts of another. Facts stay as they are, and so does a fault in other words than today's.
export function spoken(text) {
  const head = /\bF(\d{3,}) /.exec(text || "");
  if (!head) return text;
  const end = head.index + head[0].length;
  const english = words[`english_${head[1]}`];
  const told = text.slice(end);
  if (!english || !told.startsWith(english)) return text.slice(0, end) + spoken(told);
  let facts = told.slice(english.length);
  if (facts.startsWith(": ")) facts = colon() + facts.slice(2);
  return text.slice(0, end) + words[`fault_${head[1]}`] + spoken(facts);
}

// Of a step, a procedure or its progress. Of "upper: view 3 of 20" only "view" is translated.
export function label(english) {
  const own = (text) => words[`label_${text}`];
  const [, text, done, total] = /^(.*?)(?: (\d+) of (\d+))?$/s.exec(english || "");
  const at = own(text) ? -1 : text.lastIndexOf(": ");
  const told = own(at < 0 ? text : text.slice(at + 2));
  if (!told) return english;
  return (at < 0 ? "" : text.slice(0, at) + colon()) + told + (total ? ` ${done} / ${total}` : "");
}
