import { mount } from "svelte";
import "./text/farm";
import "./styles/fonts.css";
import "$draw/tokens.css";
import "./styles/base.css";
import "./styles/facts.css";
import Farm from "./farm/Farm.svelte";

const target = document.getElementById("page");
if (!target) throw new Error("The page has no place for its content.");
mount(Farm, { target });
