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

// {0}, {1} stand for what is given besides.
export function t(key, ...values) {
  const text = words[key] ?? fallback[key] ?? key;
  return values.reduce((done, value, i) => done.replaceAll(`{${i}}`, value), text);
}

// What the daemon said in English, unless the language has words of its own for its number.
export const given = (key, english) => words[key] ?? (english || (fallback[key] ?? ""));
