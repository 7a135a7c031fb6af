import { mount } from "svelte";
import "./text/printer";
import "./styles/fonts.css";
import "$draw/tokens.css";
import "./styles/base.css";
import "./styles/facts.css";
import "$draw/draw.css";
import App from "./App.svelte";

const target = document.getElementById("page");
if (!target) throw new Error("The page has no place for its content.");
mount(App, { target });
